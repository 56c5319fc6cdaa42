#include "scene/joint_reader.h"

#include "dynamics/make_joint.h"
#include "scene/scene.h"

#include "lockwind/trig.h"

#include <algorithm>

namespace lockwind {
namespace {

constexpr Range kPlace{-30000, 30000, "m"};
constexpr Range kDirection{-1, 1, ""};
constexpr Range kLength{-500, 500, "m"};
constexpr Range kDistance{0, 500, "m"};
constexpr Range kDegrees{-180, 180, "degrees"};
constexpr Range kForce{0, 1e9, "N or N m"};
constexpr Vec3 kAxisX{1, 0, 0};
constexpr Vec3 kAxisZ{0, 0, 1};

Real to_radians(Real degrees) {
    return degrees * kPi / Real(180);
}

/// The shortest turn that brings x to `axis`, then one about it that brings z towards `spin`.
RealQuat frame_of(const Vec3& axis, const Vec3& spin) {
    const Vec3 turn = cross(kAxisX, axis);
    const Real cosine = dot(kAxisX, axis);
    const RealQuat first = cosine > Real(-0.999999)
                               ? normalized(RealQuat{turn.x, turn.y, turn.z, cosine + Real(1)})
                               : RealQuat{0, 0, 1, 0};
    if (spin == Vec3{}) {
        return first;
    }
    const Vec3 z = rotate(first, kAxisZ);
    const Angle angle = atan2_angle(dot(axis, cross(z, spin)), dot(z, spin));
    return normalized(from_axis_angle(axis, angle) * first);
}

void read_spring(const FieldReader& reader,
                 bool exists,
                 const Range& rest,
                 JointDefinition& definition) {
    if (!exists) {
        return;
    }
    const FieldReader spring = reader.nested("spring");
    definition.has_spring = true;
    definition.spring_hertz = spring.real("hertz", 1, {0.01, 1000, "Hz"});
    definition.spring_damping = spring.real("damping_ratio", 1, {0, 100, ""});
    if (definition.kind == JointKind::hinge) {
        definition.rest_angle = to_radians(spring.real("rest", 0, rest));
    } else {
        definition.rest_length = spring.real("rest", definition.rest_length, rest);
    }
}

void read_motor(const FieldReader& reader, bool exists, JointDefinition& definition) {
    if (exists) {
        const FieldReader motor = reader.nested("motor");
        definition.has_motor = true;
        definition.motor_speed = motor.real("speed", 0, {-1000, 1000, "m/s or rad/s"});
        definition.motor_max = motor.real("max", 0, kForce);
    }
}

void read_length_limit(const FieldReader& reader,
                       bool exists,
                       const Range& range,
                       JointDefinition& definition) {
    if (!exists) {
        return;
    }
    const FieldReader limit = reader.nested("limit");
    definition.has_limit = true;
    definition.length_min = limit.real("min", 0, range);
    definition.length_max = limit.real("max", 0, range);
    if (definition.length_min > definition.length_max) {
        limit.fail("min", "is above max");
    }
}

void read_angle_limit(const FieldReader& reader,
                      const std::string& field,
                      bool exists,
                      JointDefinition& definition) {
    definition.has_limit = definition.has_limit || exists;
    if (!exists) {
        return;
    }
    const FieldReader limit = reader.nested(field);
    definition.angle_min = to_radians(limit.real("min", 0, kDegrees));
    definition.angle_max = to_radians(limit.real("max", 0, kDegrees));
    if (definition.angle_min > definition.angle_max) {
        limit.fail("min", "is above max");
    }
}

/// "name" or "name[3]".
struct BodyName {
    std::string name;
    std::uint64_t index;
    bool indexed;
};

BodyName split_name(const std::string& text) {
    const std::size_t open = text.find('[');
    if (open == std::string::npos || text.back() != ']' || text.size() - open > 9) {
        return {text, 0, false};
    }
    std::uint64_t index = 0;
    for (std::size_t at = open + 1; at + 1 < text.size(); ++at) {
        if (text[at] < '0' || text[at] > '9') {
            return {text, 0, false};
        }
        index = 10 * index + static_cast<std::uint64_t>(text[at] - '0');
    }
    return {text.substr(0, open), index, true};
}

} // namespace

JointReader::JointReader(const scene_text::Scene& scene,
                         const FieldReader& reader,
                         WorldDefinition& world)
    : scene_(scene), reader_(reader), world_(world) {}

void JointReader::note_body(int index, std::size_t first, std::size_t count) {
    const scene_text::Body& body = scene_.body(index);
    if (body.name().empty()) {
        return;
    }
    const FieldReader reader = reader_.nested("body", index);
    if (body.name().find('[') != std::string::npos) {
        reader.fail("name", "has a [; that is for bodies of an arrangement");
    }
    for (const Named& other : named_) {
        if (other.name == body.name()) {
            reader.fail("name", "\"" + body.name() + "\" is another body's already");
        }
    }
    const bool arranged = body.arrangement_case() != scene_text::Body::ARRANGEMENT_NOT_SET;
    named_.push_back({body.name(), first + 1, count, arranged});
}

BodyId JointReader::find_body(const FieldReader& reader,
                              const std::string& field,
                              const std::string& name) {
    if (name.empty()) {
        reader.fail(field, "is missing; give the name of a body");
        return 0;
    }
    const BodyName wanted = split_name(name);
    const auto found = std::find_if(named_.begin(), named_.end(), [&](const Named& named) {
        return named.name == wanted.name;
    });
    if (found == named_.end()) {
        reader.fail(field, "\"" + name + "\" is no body's name");
        return 0;
    }
    if (found->arranged != wanted.indexed || wanted.index >= found->count) {
        reader.fail(field,
                    "\"" + name + "\" is none of its bodies; " +
                        (found->arranged ? "give " + found->name + "[0] .. " + found->name + "[" +
                                               std::to_string(found->count - 1) + "]"
                                         : "give " + found->name));
        return 0;
    }
    return found->first + wanted.index;
}

void JointReader::read_joint(int index) {
    const scene_text::Joint& joint = scene_.joint(index);
    const FieldReader reader = reader_.nested("joint", index);
    JointDefinition definition;
    definition.id = static_cast<JointId>(index) + 1;
    const bool is_grab = joint.has_grab();
    if (is_grab && !joint.body_a().empty()) {
        reader.fail("body_a", "is given, but a grab holds body_b alone");
    }
    definition.body_a = is_grab ? 0 : find_body(reader, "body_a", joint.body_a());
    definition.body_b = find_body(reader, "body_b", joint.body_b());
    if ((definition.body_a == 0 && !is_grab) || definition.body_b == 0) {
        return;
    }
    if (definition.body_a == definition.body_b) {
        reader.fail("body_b", "is body_a too; a joint joins two bodies");
    }
    const auto moves = [&](BodyId id) {
        return id != 0 && world_.bodies[static_cast<std::size_t>(id - 1)].mode == BodyMode::dynamic;
    };
    if (!moves(definition.body_a) && !moves(definition.body_b)) {
        reader.fail("body_b",
                    is_grab ? "is not dynamic" : "and body_a are not dynamic; one must be");
    }
    definition.collide_connected = joint.collide_connected();
    definition.break_force = reader.real("break_force", 0, kForce);
    definition.break_torque = reader.real("break_torque", 0, kForce);
    read_frames(joint, reader, definition);
    read_kind(joint, reader, definition);
    world_.joints.push_back(definition);
}

void JointReader::read_frames(const scene_text::Joint& joint,
                              const FieldReader& reader,
                              JointDefinition& definition) {
    const Vec3 anchor = reader.vector("anchor", {}, kPlace);
    const Vec3 other = joint.has_distance() ? reader.vector("anchor_b", {}, kPlace) : anchor;
    if (!joint.has_distance() && joint.has_anchor_b()) {
        reader.fail("anchor_b", "is for a distance alone; others bring one anchor together");
    }
    const Vec3 axis = reader.vector("axis", kAxisX, kDirection);
    const Vec3 spin = reader.vector("spin_axis", {}, kDirection);
    if (axis == Vec3{}) {
        reader.fail("axis", "is 0; give a direction, such as { y: 1 }");
        return;
    }
    const RealQuat frame = frame_of(normalized(axis), spin);
    const auto place = [&](BodyId id, const Vec3& point, const char* field, Vec3& local) {
        const BodyDefinition& body = world_.bodies[static_cast<std::size_t>(id - 1)];
        const RealQuat back = conjugate(normalized(body.orientation));
        local = rotate(back, point - body.position);
        if (abs(local.x) > kJointAnchorMax || abs(local.y) > kJointAnchorMax ||
            abs(local.z) > kJointAnchorMax) {
            reader.fail(field, "is more than 400 m from its body");
        }
        return normalized(back * frame);
    };
    if (definition.body_a != 0) {
        definition.frame_a = place(definition.body_a, anchor, "anchor", definition.anchor_a);
    }
    definition.frame_b = place(definition.body_b,
                               other,
                               joint.has_distance() ? "anchor_b" : "anchor",
                               definition.anchor_b);
    definition.target = anchor;
    definition.rest_length = joint.has_distance() ? length(other - anchor) : Real(0);
}

void JointReader::read_kind(const scene_text::Joint& joint,
                            const FieldReader& reader,
                            JointDefinition& definition) {
    switch (joint.kind_case()) {
    case scene_text::Joint::kBall:
        definition.kind = JointKind::ball;
        break;
    case scene_text::Joint::kDistance: {
        const FieldReader kind = reader.nested("distance");
        definition.kind = JointKind::distance;
        read_length_limit(kind, joint.distance().has_limit(), kDistance, definition);
        read_spring(kind, joint.distance().has_spring(), kDistance, definition);
        if (!definition.has_limit && !definition.has_spring) {
            definition.has_limit = true;
            definition.length_min = definition.rest_length;
            definition.length_max = definition.rest_length;
        }
        break;
    }
    case scene_text::Joint::kHinge: {
        const FieldReader kind = reader.nested("hinge");
        definition.kind = JointKind::hinge;
        read_angle_limit(kind, "limit", joint.hinge().has_limit(), definition);
        read_motor(kind, joint.hinge().has_motor(), definition);
        read_spring(kind, joint.hinge().has_spring(), kDegrees, definition);
        break;
    }
    case scene_text::Joint::kSlider: {
        const FieldReader kind = reader.nested("slider");
        definition.kind = JointKind::slider;
        read_length_limit(kind, joint.slider().has_limit(), kLength, definition);
        read_motor(kind, joint.slider().has_motor(), definition);
        read_spring(kind, joint.slider().has_spring(), kLength, definition);
        break;
    }
    case scene_text::Joint::kWeld:
        definition.kind = JointKind::fixed;
        read_spring(reader.nested("weld"), joint.weld().has_spring(), kLength, definition);
        break;
    case scene_text::Joint::kWheel: {
        const FieldReader kind = reader.nested("wheel");
        definition.kind = JointKind::wheel;
        read_length_limit(kind, joint.wheel().has_limit(), kLength, definition);
        read_motor(kind, joint.wheel().has_motor(), definition);
        read_spring(kind, joint.wheel().has_spring(), kLength, definition);
        break;
    }
    case scene_text::Joint::kConeTwist: {
        const FieldReader kind = reader.nested("cone_twist");
        definition.kind = JointKind::cone_twist;
        definition.has_limit = true;
        definition.angle_min = -kPi;
        definition.angle_max = kPi;
        definition.swing_max = to_radians(kind.real("swing_degrees", 0, {0, 180, "degrees"}));
        read_angle_limit(kind, "twist", joint.cone_twist().has_twist(), definition);
        break;
    }
    case scene_text::Joint::kGrab: {
        const FieldReader kind = reader.nested("grab");
        definition.kind = JointKind::grab;
        read_spring(kind, true, kLength, definition);
        definition.motor_max = kind.real("force_max", 0, kForce);
        break;
    }
    default:
        reader.fail("",
                    "has no kind; give ball, distance, hinge, slider, weld, wheel, cone_twist or "
                    "grab");
        break;
    }
}

} // namespace lockwind
