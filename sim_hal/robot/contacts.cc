#include "sim_hal/robot/contacts.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {

namespace {

// Above this speed a contact counts as slipping and friction follows the slip [m/s].
constexpr double kSlipping_m_s = 0.005;
// Friction across the slip while slipping, as part of the coefficient: keeps the direction from
// jittering and adds 1 % to the total.
constexpr double kAcross = 0.15;
// How far the trunk may be from the ground and still be tested.
constexpr double kMargin_m = 0.01;
constexpr double kSelfFriction = 0.3;  // of the robot's shells on each other

Vector3 vector(const dReal* v) { return {v[0], v[1], v[2]}; }

bool apart(const std::array<dReal, 6>& a, const std::array<dReal, 6>& b) {
  return a[0] > b[1] || b[0] > a[1] || a[2] > b[3] || b[2] > a[3] || a[4] > b[5] || b[4] > a[5];
}

dGeomID make_box(const TerrainBox& box) {
  return dCreateBox(nullptr, 2 * box.half_length_m, 2 * box.half_width_m, box.top_m - box.bottom_m);
}

void place_box(dGeomID geom, const TerrainBox& box) {
  dMatrix3 r{};
  dRFromAxisAndAngle(r, 0, 0, 1, std::atan2(box.sin_yaw, box.cos_yaw));
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, box.x_m, box.y_m, box.bottom_m + (box.top_m - box.bottom_m) / 2);
}

void place_capsule(dGeomID geom, const Vector3& middle) {
  dGeomSetOffsetPosition(geom, middle.x(), middle.y(), middle.z());
}

}  // namespace

Contacts::Contacts(dWorldID world, const Articulation& robot, const Terrain& terrain,
                   const TerrainIndex& index, const SolidIndex& solids, const PhysicsConfig& config)
    : world_(world),
      index_(index),
      config_(config),
      friction_(terrain.friction),
      grid_(terrain.grid),
      solids_(solids) {
  make_shapes(robot);
  make_self_pairs();
  make_terrain(terrain);
  make_solids();
  group_ = dJointGroupCreate(0);
  // ODE keeps a group's arenas when it is emptied: filling it once means no allocation later.
  dContact contact{};
  for (std::size_t i = 0; i < kMaxPerStep; ++i) dJointCreateContact(world_, group_, &contact);
  dJointGroupEmpty(group_);
}

Contacts::~Contacts() {
  dJointGroupDestroy(group_);
  for (const dGeomID geom : geoms_) dGeomDestroy(geom);
  for (const dGeomID geom : boxes_) dGeomDestroy(geom);
  for (const dGeomID geom : solid_geoms_) dGeomDestroy(geom);
  for (const dGeomID geom : walker_geoms_) dGeomDestroy(geom);
  if (obstacle_ != nullptr) dGeomDestroy(obstacle_);
  dGeomDestroy(plane_);
}

void Contacts::make_shapes(const Articulation& robot) {
  const robot::RobotModel& model = robot.model();
  geoms_[kTrunk] =
      dCreateBox(nullptr, model.trunk_size_m[0], model.trunk_size_m[1], model.trunk_size_m[2]);
  dGeomSetBody(geoms_[kTrunk], robot.body(0));
  place_capsule(geoms_[kTrunk], -robot.centre_of_mass_m(0));
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t thigh = body_of(robot::joint_index(leg, 1));
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const Vector3 foot_m(0, 0, -model.shank_length_m);
    const double knee_y = robot::left_sign(leg) * model.knee_offset_m;
    const dGeomID foot = dCreateSphere(nullptr, model.foot_radius_m);
    dGeomSetBody(foot, robot.body(shank));
    place_capsule(foot, foot_m - robot.centre_of_mass_m(shank));
    const dGeomID lower = dCreateCapsule(nullptr, model.shank_radius_m, model.shank_length_m);
    dGeomSetBody(lower, robot.body(shank));
    place_capsule(lower, 0.5 * foot_m - robot.centre_of_mass_m(shank));
    const dGeomID upper = dCreateCapsule(nullptr, model.thigh_radius_m, model.thigh_length_m);
    dGeomSetBody(upper, robot.body(thigh));
    place_capsule(upper,
                  Vector3(0, knee_y, -0.5 * model.thigh_length_m) - robot.centre_of_mass_m(thigh));
    geoms_[shape_of(leg, Shape::kFoot)] = foot;
    geoms_[shape_of(leg, Shape::kShank)] = lower;
    geoms_[shape_of(leg, Shape::kThigh)] = upper;
  }
}

void Contacts::make_terrain(const Terrain& terrain) {
  plane_ = dCreatePlane(nullptr, 0, 0, 1, 0);
  for (const TerrainBox& box : terrain.boxes) {
    boxes_.push_back(make_box(box));
    place_box(boxes_.back(), box);
  }
}

void Contacts::make_solids() {
  for (const Solid& solid : solids_.solids()) {
    if (solid.is_box()) {
      solid_geoms_.push_back(make_box(solid.box));
      place_box(solid_geoms_.back(), solid.box);
      continue;
    }
    const Capsule& capsule = solid.capsule;
    const Vector3 axis = capsule.b_m - capsule.a_m;
    const Vector3 middle = 0.5 * (capsule.a_m + capsule.b_m);
    const double length = axis.norm();
    const dGeomID geom = length > 0 ? dCreateCapsule(nullptr, capsule.radius_m, length)
                                    : dCreateSphere(nullptr, capsule.radius_m);
    if (length > 0) {
      dMatrix3 r{};
      dRFromZAxis(r, axis.x(), axis.y(), axis.z());
      dGeomSetRotation(geom, r);
    }
    dGeomSetPosition(geom, middle.x(), middle.y(), middle.z());
    solid_geoms_.push_back(geom);
  }
}

// Moved by hand; the velocity is what the solver gives them to push with.
void Contacts::place_walkers(const Walkers& walkers) {
  const std::span<const Solid> solids = walkers.solids();
  for (std::size_t i = walker_geoms_.size(); i < solids.size(); ++i) {
    const Capsule& capsule = solids[i].capsule;
    const double length = capsule.b_m.z() - capsule.a_m.z();
    walker_bodies_.push_back(dBodyCreate(world_));
    dBodySetKinematic(walker_bodies_.back());
    walker_geoms_.push_back(dCreateCapsule(nullptr, capsule.radius_m, length));
    dGeomSetBody(walker_geoms_.back(), walker_bodies_.back());
  }
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const Vector3 middle = 0.5 * (solids[i].capsule.a_m + solids[i].capsule.b_m);
    const Vector3& velocity = walkers.velocities_m_s()[i];
    dBodySetPosition(walker_bodies_[i], middle.x(), middle.y(), middle.z());
    dBodySetLinearVel(walker_bodies_[i], velocity.x(), velocity.y(), velocity.z());
  }
}

void Contacts::collide_solids(std::size_t shape) {
  if (solid_geoms_.empty() && walker_geoms_.empty()) return;
  std::array<dReal, 6> part{};
  dGeomGetAABB(geoms_[shape], part.data());
  const auto meet = [&](dGeomID solid) {
    std::array<dReal, 6> bounds{};
    dGeomGetAABB(solid, bounds.data());
    if (!apart(part, bounds) && collide_pair(shape, solid) > 0) on_obstacle_ = true;
  };
  std::array<std::uint32_t, SolidIndex::kMaxCandidates> near;
  const std::size_t count = solids_.near(part[0], part[2], part[1], part[3], near);
  for (std::size_t k = 0; k < count; ++k) meet(solid_geoms_[near[k]]);
  for (const dGeomID walker : walker_geoms_) meet(walker);
}

void Contacts::place_obstacle(const TerrainBox& box) {
  if (obstacle_ == nullptr) obstacle_ = make_box(box);
  place_box(obstacle_, box);
}

void Contacts::collide() {
  count_ = 0;
  self_count_ = 0;
  on_obstacle_ = false;
  for (std::size_t i = 0; i < kShapes; ++i) collide_shape(i);
  collide_self();
}

void Contacts::make_self_pairs() {
  std::size_t count = 0;
  const auto pair = [&](std::size_t a, std::size_t b) {
    self_pairs_[count++] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
  };
  constexpr std::array<Shape, 3> kAll{Shape::kFoot, Shape::kShank, Shape::kThigh};
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    pair(kTrunk, shape_of(leg, Shape::kFoot));
    pair(kTrunk, shape_of(leg, Shape::kShank));
    for (std::size_t other = leg + 1; other < robot::kLegs; ++other) {
      for (const Shape a : kAll) {
        for (const Shape b : kAll) pair(shape_of(leg, a), shape_of(other, b));
      }
    }
  }
}

// Boxes of the pairs first: a robot that walks touches itself nowhere.
void Contacts::collide_self() {
  std::array<std::array<dReal, 6>, kShapes> bounds{};
  for (std::size_t i = 0; i < kShapes; ++i) dGeomGetAABB(geoms_[i], bounds[i].data());
  for (const SelfPair& pair : self_pairs_) {
    if (apart(bounds[pair[0]], bounds[pair[1]])) continue;
    std::array<dContactGeom, kMaxPerPair> found;
    const int count =
        dCollide(geoms_[pair[0]], geoms_[pair[1]], kMaxPerPair, found.data(), sizeof(dContactGeom));
    for (int i = 0; i < count; ++i) add_self(found[static_cast<std::size_t>(i)]);
  }
}

double Contacts::self_overlap_m() const {
  double deepest = 0;
  for (const SelfPair& pair : self_pairs_) {
    std::array<dContactGeom, kMaxPerPair> found;
    const int count =
        dCollide(geoms_[pair[0]], geoms_[pair[1]], kMaxPerPair, found.data(), sizeof(dContactGeom));
    for (int i = 0; i < count; ++i) {
      deepest = std::max(deepest, double{found[static_cast<std::size_t>(i)].depth});
    }
  }
  return deepest;
}

// Kept out of the records: what the robot feels of the ground is not what it feels of itself.
void Contacts::add_self(const dContactGeom& geometry) {
  if (count_ + self_count_ == kMaxPerStep) {
    ++dropped_;
    return;
  }
  deepest_self_m_ = std::max(deepest_self_m_, double{geometry.depth});
  dContact contact{};
  contact.geom = geometry;
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = kSelfFriction;
  contact.surface.soft_erp = config_.contact_erp;
  contact.surface.soft_cfm = config_.contact_cfm;
  const dJointID joint = dJointCreateContact(world_, group_, &contact);
  dJointAttach(joint, dGeomGetBody(geometry.g1), dGeomGetBody(geometry.g2));
  ++self_count_;
}

void Contacts::collide_shape(std::size_t shape) {
  collide_ground(shape);
  collide_solids(shape);
  if (obstacle_ == nullptr) return;
  std::array<dReal, 6> part{};
  std::array<dReal, 6> obstacle{};
  dGeomGetAABB(geoms_[shape], part.data());
  dGeomGetAABB(obstacle_, obstacle.data());
  if (apart(part, obstacle)) return;
  if (collide_pair(shape, obstacle_) > 0) on_obstacle_ = true;
}

void Contacts::collide_ground(std::size_t shape) {
  dReal bounds[6];
  dGeomGetAABB(geoms_[shape], bounds);
  const double x0 = bounds[0] - kMargin_m;
  const double x1 = bounds[1] + kMargin_m;
  const double y0 = bounds[2] - kMargin_m;
  const double y1 = bounds[3] + kMargin_m;
  if (bounds[4] > index_.max_height_m(x0, y0, x1, y1)) return;
  // A leg may lie across the grid's border.
  if (grid_.overlaps(x0, y0, x1, y1)) collide_grid(shape);
  const bool inside = grid_.contains(x0, y0) && grid_.contains(x1, y1);
  if (!inside && bounds[4] <= 0) collide_pair(shape, plane_);
  if (boxes_.empty()) return;
  std::array<std::uint32_t, TerrainIndex::kMaxCandidates> near;
  const std::size_t count = index_.boxes_near(x0, y0, x1, y1, near);
  for (std::size_t k = 0; k < count; ++k) collide_pair(shape, boxes_[near[k]]);
}

int Contacts::collide_pair(std::size_t shape, dGeomID ground) {
  std::array<dContactGeom, kMaxPerPair> found;
  const int count =
      dCollide(geoms_[shape], ground, kMaxPerPair, found.data(), sizeof(dContactGeom));
  const dBodyID other = dGeomGetBody(ground);
  for (int i = 0; i < count; ++i) add(shape, found[static_cast<std::size_t>(i)], other);
  return count;
}

// Capsules as balls a radius apart at most; the trunk, which only falls, as points of its surface.
void Contacts::collide_grid(std::size_t shape) {
  const dGeomID geom = geoms_[shape];
  const Vector3 centre = vector(dGeomGetPosition(geom));
  const dReal* r = dGeomGetRotation(geom);
  if (shape == kTrunk) {
    dReal size[3];
    dGeomBoxGetLengths(geom, size);
    for (int k = 0; k < 27; ++k) {
      const double x = 0.5 * size[0] * (k % 3 - 1);
      const double y = 0.5 * size[1] * (k / 3 % 3 - 1);
      const double z = 0.5 * size[2] * (k / 9 - 1);
      touch_grid(shape,
                 centre + Vector3(r[0] * x + r[1] * y + r[2] * z, r[4] * x + r[5] * y + r[6] * z,
                                  r[8] * x + r[9] * y + r[10] * z),
                 0.0);
    }
    return;
  }
  if (dGeomGetClass(geom) == dSphereClass) {
    touch_grid(shape, centre, dGeomSphereGetRadius(geom));
    return;
  }
  dReal radius = 0;
  dReal length = 0;
  dGeomCapsuleGetParams(geom, &radius, &length);
  const Vector3 axis(r[2], r[6], r[10]);
  const int parts = static_cast<int>(std::ceil(length / radius));
  for (int k = 0; k <= parts; ++k) {
    touch_grid(shape, centre + axis * (length * (static_cast<double>(k) / parts - 0.5)), radius);
  }
}

void Contacts::touch_grid(std::size_t shape, const Vector3& centre_m, double radius_m) {
  std::array<GridContact, kMaxPerPair> found;
  const std::size_t count = sphere_on_grid(grid_, centre_m, radius_m, found);
  for (std::size_t k = 0; k < count; ++k) {
    dContactGeom geometry{};
    for (int axis = 0; axis < 3; ++axis) {
      geometry.pos[axis] = found[k].position_m[axis];
      geometry.normal[axis] = found[k].normal[axis];
    }
    geometry.depth = found[k].depth_m;
    geometry.g1 = geoms_[shape];
    add(shape, geometry);
  }
}

// The normal of an ODE contact points into the first geom, here always the robot's.
//
// Friction is limited by the normal force of the last step. ODE's own pyramid (dContactApprox1)
// takes the normal forces that it finds without any friction: where the legs would slide apart
// these are other forces, and a crouching robot slipped forwards at 0.27, backwards at 0.34 for a
// coefficient of 0.30. It serves for the first step of a contact.
void Contacts::add(std::size_t shape, const dContactGeom& geometry, dBodyID other) {
  if (count_ == kMaxPerStep) {
    ++dropped_;
    return;
  }
  const dBodyID body = dGeomGetBody(geoms_[shape]);
  dVector3 velocity_W;
  dBodyGetPointVel(body, geometry.pos[0], geometry.pos[1], geometry.pos[2], velocity_W);
  const Vector3 normal = vector(geometry.normal);
  const Vector3 velocity = vector(velocity_W);
  const Vector3 slip = velocity - normal * normal.dot(velocity);
  const bool slipping = slip.norm() > kSlipping_m_s;
  const Vector3& last = shapes_[shape].force_N;
  Vector3 along = slipping ? slip : Vector3(last - normal * normal.dot(last));
  if (along.norm() < 1e-9) {
    along = std::fabs(normal.x()) < 0.7 ? Vector3(Vector3(1, 0, 0) - normal * normal.x())
                                        : Vector3(Vector3(0, 1, 0) - normal * normal.y());
  }
  along.normalize();
  dContact contact{};
  contact.geom = geometry;
  contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactFDir1 | dContactMu2;
  contact.surface.mu = friction_ * shapes_[shape].pressure_N;
  if (contact.surface.mu == 0.0) {
    contact.surface.mode |= dContactApprox1;
    contact.surface.mu = friction_;
  }
  contact.surface.mu2 = contact.surface.mu * (slipping ? kAcross : 1.0);
  contact.surface.soft_erp = config_.contact_erp;
  contact.surface.soft_cfm = config_.contact_cfm;
  for (int k = 0; k < 3; ++k) contact.fdir1[k] = along[k];
  const dJointID joint = dJointCreateContact(world_, group_, &contact);
  dJointSetFeedback(joint, &feedback_[count_]);
  dJointAttach(joint, body, other);
  records_[count_] = {shape, normal, slip};
  ++count_;
}

void Contacts::collect() {
  std::array<double, kShapes> largest{};
  std::array<double, kShapes> pressing{};
  shapes_.fill({});
  for (std::size_t i = 0; i < count_; ++i) {
    const Vector3 force = vector(feedback_[i].f1);
    const double pressure = records_[i].normal.dot(force);
    ShapeContact& shape = shapes_[records_[i].shape];
    shape.force_N += force;
    shape.touching = shape.touching || pressure > 0;
    if (pressure > 0) {
      shape.pressure_N += pressure;
      pressing[records_[i].shape] += 1.0;
    }
    if (pressure > largest[records_[i].shape]) {
      largest[records_[i].shape] = pressure;
      shape.slip_velocity_m_s = records_[i].slip;
    }
  }
  for (std::size_t i = 0; i < kShapes; ++i) {
    if (pressing[i] > 0) shapes_[i].pressure_N /= pressing[i];
  }
  dJointGroupEmpty(group_);
}

}  // namespace surefoot::sim
