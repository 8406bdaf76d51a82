#include "sim_hal/world/rock_field.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.h"
#include "core/math/linear.h"
#include "sim_hal/robot/ode_runtime.h"
#include "sim_hal/robot/random_pose.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/convex_hull.h"

namespace surefoot::sim {

namespace {

constexpr double kStepTime_s = 0.0025;
constexpr int kSolverIterations = 30;
constexpr double kGravity_m_s2 = 9.81;
constexpr double kFriction = 0.7;
constexpr double kDensity_kg_m3 = 2500;
constexpr double kSurfaceLayer_m = 0.0005;
constexpr double kMaxCorrection_m_s = 0.3;
constexpr double kDamping = 0.006;  // of velocities, per step: rocks are not billiard balls
constexpr int kMaxContacts = 32;
constexpr double kRestSpeed_m_s = 0.005;
constexpr int kRestSteps = 10;  // in a row below the speed
constexpr double kLongest_s = 8;
constexpr double kDropHeight_m = 0.05;

// Random streams of a seed.
enum : std::uint64_t { kShapes = 1, kPlaces, kKernel };

struct Rock {
  ConvexBody hull;  // about its centre of mass
  double radius_m = 0;
  dBodyID body = nullptr;
};

Rock make_rock(const RockFieldOptions& options, Random& random) {
  Vector3 deviation;
  for (int axis = 0; axis < 3; ++axis) {
    deviation[axis] =
        options.point_deviation_m * random.uniform(options.least_factor, options.most_factor);
  }
  const Matrix3 rotation = random_rotation(random);
  std::vector<Vector3> points;
  for (int i = 0; i < options.points_per_body; ++i) {
    const Vector3 point{random.normal(), random.normal(), random.normal()};
    points.push_back(rotation * point.cwiseProduct(deviation));
  }
  Rock rock;
  rock.hull = convex_hull(points);
  const Vector3 centroid = solid_of(rock.hull).centroid_m;
  for (Vector3& point : rock.hull.points_m) {
    point -= centroid;
    rock.radius_m = std::max(rock.radius_m, point.norm());
  }
  return rock;
}

// Where the rocks begin to fall: each at a random place, resting on the bounding spheres of those
// before it, so that no two begin inside each other.
std::vector<Vector3> starting_places(const std::vector<Rock>& rocks, double length_m,
                                     double width_m, Random& random) {
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < rocks.size(); ++i) {
    const double radius = rocks[i].radius_m;
    Vector3 place{random.uniform(radius, length_m - radius),
                  random.uniform(radius, width_m - radius), radius + kDropHeight_m};
    for (std::size_t k = 0; k < i; ++k) {
      const double apart = (place - places[k]).head<2>().norm();
      const double together = radius + rocks[k].radius_m;
      if (apart >= together) continue;
      place.z() = std::max(place.z(),
                           places[k].z() + std::sqrt(together * together - apart * apart) + 0.001);
    }
    places.push_back(place);
  }
  return places;
}

// The box and what falls into it. One ODE world; everything goes with it.
class RockBox {
 public:
  RockBox(std::vector<Rock>& rocks, const std::vector<Vector3>& places,
          const RockFieldOptions& options);
  ~RockBox();
  RockBox(const RockBox&) = delete;
  RockBox& operator=(const RockBox&) = delete;

  void settle(RockField& field);

 private:
  void add(Rock& rock, const Vector3& place_m);
  void step();
  void collide(dGeomID a, dGeomID b);
  double max_speed_m_s() const;

  std::vector<Rock>& rocks_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dTriMeshDataID> meshes_;
  std::vector<std::vector<double>> vertices_;  // ODE keeps pointers to both
  std::vector<std::vector<dTriIndex>> indices_;
  double deepest_m_ = 0;
};

RockBox::RockBox(std::vector<Rock>& rocks, const std::vector<Vector3>& places,
                 const RockFieldOptions& options)
    : rocks_(rocks),
      world_(dWorldCreate()),
      space_(dSimpleSpaceCreate(nullptr)),
      contacts_(dJointGroupCreate(0)) {
  dWorldSetGravity(world_, 0, 0, -kGravity_m_s2);
  dWorldSetQuickStepNumIterations(world_, kSolverIterations);
  dWorldSetContactMaxCorrectingVel(world_, kMaxCorrection_m_s);
  dWorldSetContactSurfaceLayer(world_, kSurfaceLayer_m);
  dWorldSetLinearDamping(world_, kDamping);
  dWorldSetAngularDamping(world_, kDamping);
  dWorldSetAutoDisableFlag(world_, 1);
  dWorldSetAutoDisableLinearThreshold(world_, kRestSpeed_m_s);
  dWorldSetAutoDisableAngularThreshold(world_, 0.1);
  dWorldSetAutoDisableSteps(world_, 40);
  dCreatePlane(space_, 0, 0, 1, 0);
  dCreatePlane(space_, 1, 0, 0, 0);
  dCreatePlane(space_, -1, 0, 0, -options.length_m);
  dCreatePlane(space_, 0, 1, 0, 0);
  dCreatePlane(space_, 0, -1, 0, -options.width_m);
  vertices_.reserve(rocks.size());
  indices_.reserve(rocks.size());
  for (std::size_t i = 0; i < rocks.size(); ++i) add(rocks[i], places[i]);
}

RockBox::~RockBox() {
  dJointGroupDestroy(contacts_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
  for (dTriMeshDataID mesh : meshes_) dGeomTriMeshDataDestroy(mesh);
}

void RockBox::add(Rock& rock, const Vector3& place_m) {
  std::vector<double>& vertices = vertices_.emplace_back();
  for (const Vector3& point : rock.hull.points_m) {
    vertices.insert(vertices.end(), {point.x(), point.y(), point.z()});
  }
  std::vector<dTriIndex>& indices = indices_.emplace_back();
  for (const auto& triangle : rock.hull.triangles) {
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  }
  dTriMeshDataID mesh = dGeomTriMeshDataCreate();
  meshes_.push_back(mesh);
  dGeomTriMeshDataBuildDouble(mesh, vertices.data(), 3 * sizeof(double),
                              static_cast<int>(vertices.size() / 3), indices.data(),
                              static_cast<int>(indices.size()), 3 * sizeof(dTriIndex));
  dGeomID geom = dCreateTriMesh(space_, mesh, nullptr, nullptr, nullptr);
  dMass mass;
  dMassSetTrimesh(&mass, kDensity_kg_m3, geom);
  mass.c[0] = mass.c[1] = mass.c[2] = 0;  // rounding only: the hull is about its centroid
  rock.body = dBodyCreate(world_);
  dBodySetMass(rock.body, &mass);
  dGeomSetBody(geom, rock.body);
  dBodySetPosition(rock.body, place_m.x(), place_m.y(), place_m.z());
}

void RockBox::collide(dGeomID a, dGeomID b) {
  dBodyID body_a = dGeomGetBody(a);
  dBodyID body_b = dGeomGetBody(b);
  const bool awake_a = body_a != nullptr && dBodyIsEnabled(body_a) != 0;
  const bool awake_b = body_b != nullptr && dBodyIsEnabled(body_b) != 0;
  if (!awake_a && !awake_b) return;
  std::array<dContact, kMaxContacts> found{};
  const int count = dCollide(a, b, kMaxContacts, &found[0].geom, sizeof(dContact));
  for (int i = 0; i < count; ++i) {
    dContact& contact = found[static_cast<std::size_t>(i)];
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = kFriction;
    deepest_m_ = std::max(deepest_m_, contact.geom.depth);
    dJointAttach(dJointCreateContact(world_, contacts_, &contact), body_a, body_b);
  }
}

void RockBox::step() {
  deepest_m_ = 0;
  dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) {
    static_cast<RockBox*>(self)->collide(a, b);
  });
  dWorldQuickStep(world_, kStepTime_s);
  dJointGroupEmpty(contacts_);
}

double RockBox::max_speed_m_s() const {
  double fastest = 0;
  for (const Rock& rock : rocks_) {
    if (dBodyIsEnabled(rock.body) == 0) continue;
    const Eigen::Map<const Vector3> v(dBodyGetLinearVel(rock.body));
    fastest = std::max(fastest, v.norm());
  }
  return fastest;
}

void RockBox::settle(RockField& field) {
  int quiet = 0;
  const int most = static_cast<int>(kLongest_s / kStepTime_s);
  int steps = 0;
  while (steps < most && quiet < kRestSteps) {
    step();
    ++steps;
    field.rest_speed_m_s = max_speed_m_s();
    quiet = field.rest_speed_m_s < kRestSpeed_m_s ? quiet + 1 : 0;
  }
  for (const Rock& rock : rocks_) dBodyEnable(rock.body);  // so that resting pairs are looked at
  deepest_m_ = 0;
  step();
  field.deepest_contact_m = deepest_m_;
  field.simulated_s = steps * kStepTime_s;
}

// Raises the samples under a triangle to its plane.
void rasterise(const std::array<Vector3, 3>& corners, RockField& field) {
  const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (normal.z() <= 0) return;  // faces down
  double low_x = corners[0].x(), high_x = low_x, low_y = corners[0].y(), high_y = low_y;
  for (const Vector3& corner : corners) {
    low_x = std::min(low_x, corner.x());
    high_x = std::max(high_x, corner.x());
    low_y = std::min(low_y, corner.y());
    high_y = std::max(high_y, corner.y());
  }
  const auto first = [](double x) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil(x / RockField::kStep_m - 0.5)));
  };
  const auto end = [](double x, std::size_t most) {
    const double last = std::floor(x / RockField::kStep_m - 0.5);
    return last < 0 ? std::size_t{0} : std::min(most, static_cast<std::size_t>(last) + 1);
  };
  for (std::size_t j = first(low_y); j < end(high_y, field.rows); ++j) {
    for (std::size_t i = first(low_x); i < end(high_x, field.columns); ++i) {
      const double x = (static_cast<double>(i) + 0.5) * RockField::kStep_m;
      const double y = (static_cast<double>(j) + 0.5) * RockField::kStep_m;
      bool inside = true;
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const Vector3& a = corners[edge];
        const Vector3& b = corners[(edge + 1) % 3];
        inside = inside && (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x()) >= 0;
      }
      if (!inside) continue;
      const double z =
          corners[0].z() -
          (normal.x() * (x - corners[0].x()) + normal.y() * (y - corners[0].y())) / normal.z();
      float& sample = field.z_m[j * field.columns + i];
      sample = std::max(sample, static_cast<float>(z));
    }
  }
}

void sample_surface(const std::vector<Rock>& rocks, const RockFieldOptions& options,
                    RockField& field) {
  field.z_m.assign(field.columns * field.rows, 0.0f);
  for (const Rock& rock : rocks) {
    const Eigen::Map<const Vector3> place(dBodyGetPosition(rock.body));
    const dReal* r = dBodyGetRotation(rock.body);  // rows of four
    Matrix3 rotation;
    rotation << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
    if (!(place.x() >= 0 && place.x() <= options.length_m && place.y() >= 0 &&
          place.y() <= options.width_m && place.z() >= 0)) {
      ++field.lost_bodies;
    }
    for (const auto& triangle : rock.hull.triangles) {
      std::array<Vector3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = place + rotation * rock.hull.points_m[triangle[k]];
      }
      rasterise(corners, field);
    }
  }
}

// Mean of the surroundings under random weights; beyond the border the outermost sample goes on.
void convolve(int side, Random& random, RockField& field) {
  std::vector<float> kernel;
  double sum = 0;
  for (int i = 0; i < side * side; ++i) {
    const double weight = random.uniform();
    sum += weight;
    kernel.push_back(static_cast<float>(weight));
  }
  for (float& weight : kernel) weight = static_cast<float>(weight / sum);
  const int columns = static_cast<int>(field.columns);
  const int rows = static_cast<int>(field.rows);
  const int padded_columns = columns + side;
  std::vector<float> row(static_cast<std::size_t>(padded_columns));
  std::vector<float> smooth(field.z_m.size(), 0.0f);
  for (int j = 0; j < rows; ++j) {
    float* out = &smooth[static_cast<std::size_t>(j) * field.columns];
    for (int v = 0; v < side; ++v) {
      const auto from = static_cast<std::size_t>(std::clamp(j + v - side / 2, 0, rows - 1));
      for (int i = 0; i < padded_columns; ++i) {
        const auto at = static_cast<std::size_t>(std::clamp(i - side / 2, 0, columns - 1));
        row[static_cast<std::size_t>(i)] = field.at(at, from);
      }
      for (int u = 0; u < side; ++u) {
        const float weight = kernel[static_cast<std::size_t>(v * side + u)];
        const float* in = &row[static_cast<std::size_t>(u)];
        for (int i = 0; i < columns; ++i) out[i] += weight * in[i];
      }
    }
  }
  field.z_m = std::move(smooth);
}

void scale_heights(double range_m, RockField& field) {
  const auto [low, high] = std::minmax_element(field.z_m.begin(), field.z_m.end());
  const float lowest = *low;
  const double range = static_cast<double>(*high) - static_cast<double>(lowest);
  if (!(range > 0)) throw SimulatorError("rock field: the ground is level, nothing to scale");
  field.scale = range_m / range;
  for (float& z : field.z_m) {
    z = static_cast<float>(static_cast<double>(z - lowest) * field.scale);
  }
}

void check(const RockFieldOptions& options) {
  const double widest =
      8 * options.point_deviation_m * options.most_factor;  // no draw makes a wider rock
  const bool good = options.bodies >= 1 && options.bodies <= 2000 && options.points_per_body >= 4 &&
                    options.points_per_body <= 40 && options.point_deviation_m > 0 &&
                    options.least_factor > 0 && options.most_factor >= options.least_factor &&
                    options.length_m >= widest && options.width_m >= widest &&
                    options.length_m <= 5 && options.width_m <= 5 && options.kernel_side >= 1 &&
                    options.kernel_side <= 100 && options.height_range_m > 0 &&
                    options.height_range_m <= 1;
  if (!good) throw SimulatorError("rock field: options out of range");
}

}  // namespace

RockField make_rock_field(const RockFieldOptions& options, std::uint64_t seed) {
  check(options);
  start_ode();
  dRandSetSeed(static_cast<unsigned long>(seed));  // the order in which QuickStep visits contacts
  Random shapes(seed, kShapes);
  std::vector<Rock> rocks;
  for (int i = 0; i < options.bodies; ++i) rocks.push_back(make_rock(options, shapes));
  Random draws(seed, kPlaces);
  const std::vector<Vector3> places =
      starting_places(rocks, options.length_m, options.width_m, draws);
  RockField field;
  field.columns = sample_count(options.length_m);
  field.rows = sample_count(options.width_m);
  RockBox box(rocks, places, options);
  box.settle(field);
  sample_surface(rocks, options, field);
  Random kernel(seed, kKernel);
  convolve(options.kernel_side, kernel, field);
  scale_heights(options.height_range_m, field);
  return field;
}

}  // namespace surefoot::sim
