// The rules of hal/api/can_port.h, once for all backends.
//
//   CAN-EMPTY     nothing waiting, or no room to put it: 0, nothing written, nothing lost
//   CAN-BOUND     never more frames than asked for
//   CAN-ORDER     stamps do not go back, equal stamps are ordered by bus, a bus keeps its order
//   CAN-FORM      delivered frames are frames: id, size and bus in range, unused bytes zero
//   CAN-COMPLETE  whatever arrives is delivered or counted as dropped
//   CAN-COUNT     counters add up and never go back
//   CAN-REFUSE    send of what is no frame: kInvalid, nothing sent
//   CAN-NO-BUS    send to a bus that is not there: kUnavailable, counted as dropped
//   CAN-SEND      every other send is kOk, or refused with a documented code; both are counted
//
// A recorded source has no bus to send on: the last three do not apply to it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/api/can_port.h"
#include "tests/conformance/violations.h"

namespace surefoot::conformance {

// A backend and what its suite needs to stimulate it.
class CanBench {
 public:
  virtual ~CanBench() = default;
  virtual hal::CanPort& port() = 0;
  // Lets `count` frames arrive on the bus, in an order that number_of() can tell. Returns how many
  // did (a recorded source may have fewer left).
  virtual std::size_t arrive(std::uint8_t bus, std::size_t count) = 0;
  // Grows from frame to frame of one bus, or -1 where the backend's frames do not tell.
  virtual std::int64_t number_of(const hal::CanFrame&) const { return -1; }
  // false: a recorded source, what is sent goes nowhere.
  virtual bool sends() const { return true; }
  // Buses that are there are 0 .. bus_count() - 1.
  virtual std::size_t bus_count() const = 0;
  // Frames that fit into the receive queue of the whole port; 0: not known or not limited.
  virtual std::size_t receive_capacity() const { return 0; }
};

Violations can_port_violations(CanBench& bench);

}  // namespace surefoot::conformance
