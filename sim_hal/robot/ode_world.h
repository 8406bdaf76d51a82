// The ODE world; owns bodies and joints.
#pragma once

#include <ode/ode.h>

#include "core/math/gravity.h"
#include "sim_hal/robot/ode_runtime.h"

namespace surefoot::sim {

class OdeWorld {
 public:
  OdeWorld() {
    start_ode();
    id_ = dWorldCreate();
    dWorldSetGravity(id_, 0, 0, -kGravity_m_s2);
    dWorldSetAutoDisableFlag(id_, 0);
    dWorldSetERP(id_, 0.2);
    dWorldSetCFM(id_, 1e-10);
    dWorldSetMaxAngularSpeed(id_, dInfinity);
    dWorldStepReserveInfo reserve{};
    reserve.struct_size = sizeof reserve;
    reserve.reserve_factor = 1.5F;
    reserve.reserve_minimum = 8U << 20U;  // enough for every contact at once: no growth later
    dWorldSetStepMemoryReservationPolicy(id_, &reserve);
  }
  ~OdeWorld() { dWorldDestroy(id_); }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  dWorldID id() const { return id_; }

 private:
  dWorldID id_;
};

}  // namespace surefoot::sim
