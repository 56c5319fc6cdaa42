#include "geometry/compound.h"

#include "geometry/convex_core.h"
#include "geometry/fixed_geometry.h"
#include "geometry/polytope.h"
#include "geometry/principal_axes.h"
#include "geometry/rotation.h"

#include "lockwind/integer.h"
#include "lockwind/overflow.h"
#include "lockwind/wide.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lockwind {

namespace {

/// Weights are volume x density in units of 2^-40 of the heaviest child's next power of two.
constexpr int kWeightBits = 40;

/// a b, of row-major matrices.
void multiply(const std::int32_t a[9], const std::int32_t b[9], std::int32_t out[9]) {
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const std::int32_t along[3] = {b[column], b[3 + column], b[6 + column]};
            out[3 * row + column] = round_unit(dot_wide(a + 3 * row, along));
        }
    }
}

void store_unit(const RealQuat& turn, std::int32_t orientation[4]) {
    const Real components[4] = {turn.x, turn.y, turn.z, turn.w};
    for (int index = 0; index < 4; ++index) {
        orientation[index] = convert<Unit>(components[index]).raw();
    }
}

RealQuat turn_of(const std::int32_t orientation[4]) {
    const auto unit = [&](int index) { return convert<Real>(Unit::from_raw(orientation[index])); };
    return {unit(0), unit(1), unit(2), unit(3)};
}

Vec3 place_of(const std::int32_t centre[3]) {
    const auto length = [&](int index) { return convert<Real>(Length::from_raw(centre[index])); };
    return {length(0), length(1), length(2)};
}

/// numerator / divisor to the nearest; the quotient fits 63 bits.
std::int64_t divide_nearest(const Int128& numerator, std::int64_t divisor) {
    const bool negative = numerator < Int128(0);
    const Int128 size = negative ? raw_subtract(Int128(0), numerator) : numerator;
    const UInt128 rounded =
        UInt128{static_cast<std::uint64_t>(raw_narrow<std::int64_t>(shift_right(size, 64))),
                low_limb(size)} +
        UInt128{0, static_cast<std::uint64_t>(divisor / 2)};
    const auto quotient =
        static_cast<std::int64_t>(divide_wide(rounded, static_cast<std::uint64_t>(divisor)).low);
    return negative ? -quotient : quotient;
}

class CompoundMaker {
public:
    CompoundMaker(const CompoundDefinition& definition, std::span<const Hull> hulls)
        : definition_(definition), hulls_(hulls) {}

    Result<Compound> run();

private:
    std::optional<Error> check(std::size_t index) const;
    std::string wrong_shape(const ShapeDefinition& shape) const;
    void place(std::size_t index);
    void weigh();
    void find_centre();
    void add_covariance(std::uint32_t child, Int128 (&sums)[3][3]) const;
    void turn();
    void measure();

    const CompoundDefinition& definition_;
    std::span<const Hull> hulls_;
    Compound compound_{}; // children in the given frame until turn()
    Volume masses_[kCompoundChildrenMax] = {};
    std::int64_t weights_[kCompoundChildrenMax] = {};
    std::int64_t weight_ = 0; // of all
};

std::string CompoundMaker::wrong_shape(const ShapeDefinition& shape) const {
    const auto is_size = [](Real value) {
        const auto stored = convert_saturated<Length>(value);
        return stored >= convert<Length>(kShapeSizeMin) && stored <= convert<Length>(kShapeSizeMax);
    };
    const char* const wrong_size = "has a size out of range; give 0.01 .. 250 m";
    switch (shape.type) {
    case ShapeType::sphere:
        return is_size(shape.radius) ? "" : wrong_size;
    case ShapeType::capsule:
        return is_size(shape.radius) && is_size(shape.half_height) ? "" : wrong_size;
    case ShapeType::box: {
        const auto& [x, y, z] = shape.half_extents;
        return is_size(x) && is_size(y) && is_size(z) ? "" : wrong_size;
    }
    case ShapeType::hull:
        return shape.hull < hulls_.size()
                   ? ""
                   : "is hull " + std::to_string(shape.hull) + "; there are " +
                         std::to_string(hulls_.size()) + " hulls";
    default:
        return "is no sphere, capsule, box or hull";
    }
}

std::optional<Error> CompoundMaker::check(std::size_t index) const {
    const CompoundChild& child = definition_.children[index];
    std::string wrong = wrong_shape(child.shape);
    const auto is_near = [](Real value) {
        return value >= -kShapeSizeMax && value <= kShapeSizeMax;
    };
    const auto& [x, y, z] = child.position;
    if (!is_near(x) || !is_near(y) || !is_near(z)) {
        wrong = "has a position beyond 250 m";
    }
    if (child.orientation == RealQuat{0, 0, 0, 0}) {
        wrong = "has orientation 0; it must be a rotation";
    }
    if (child.density < kCompoundDensityMin || child.density > kCompoundDensityMax) {
        wrong = "has a density out of range; give 0.001 .. 1000 times the body's";
    }
    if (wrong.empty()) {
        return std::nullopt;
    }
    return Error{"child " + std::to_string(index) + " " + wrong};
}

/// Fills a child in the given frame.
void CompoundMaker::place(std::size_t index) {
    const CompoundChild& from = definition_.children[index];
    const ShapeDefinition& shape = from.shape;
    CompoundShape& child = compound_.children[index];
    child.type = shape.type;
    const auto set_size = [&](int axis, Real value) {
        child.size[axis] = convert<Length>(value).raw();
    };
    RealQuat orientation = normalized(from.orientation);
    Vec3 position = from.position;
    if (shape.type == ShapeType::hull) {
        child.hull = &hulls_[shape.hull];
        position += rotate(orientation, place_of(child.hull->centre));
        orientation = normalized(orientation * turn_of(child.hull->orientation));
    } else if (shape.type == ShapeType::box) {
        set_size(0, shape.half_extents.x);
        set_size(1, shape.half_extents.y);
        set_size(2, shape.half_extents.z);
    } else {
        set_size(0, shape.radius);
        set_size(1, shape.type == ShapeType::capsule ? shape.half_height : Real(0));
    }
    child.position[0] = convert_saturated<Length>(position.x).raw();
    child.position[1] = convert_saturated<Length>(position.y).raw();
    child.position[2] = convert_saturated<Length>(position.z).raw();
    std::int32_t stored[4];
    store_unit(orientation, stored);
    rotation_matrix(stored, child.rotation);
    const Volume volume =
        shape.type == ShapeType::hull ? child.hull->volume : volume_of(child.type, child.size);
    const auto density = static_cast<std::uint64_t>(from.density.raw());
    masses_[index] =
        leading_bits(multiply_wide(volume.mantissa, density), volume.fraction + Real::kFraction);
}

void CompoundMaker::weigh() {
    int top = std::numeric_limits<int>::min();
    const std::uint32_t count = compound_.child_count;
    for (std::uint32_t child = 0; child < count; ++child) {
        top =
            std::max(top, bit_width(UInt128{0, masses_[child].mantissa}) - masses_[child].fraction);
    }
    for (std::uint32_t child = 0; child < count; ++child) {
        const int shift = masses_[child].fraction + top - kWeightBits;
        const UInt128 mantissa{0, masses_[child].mantissa};
        const UInt128 weight = shift > 0 ? mantissa >> std::min(shift, 127) : mantissa << -shift;
        weights_[child] = static_cast<std::int64_t>(weight.low);
        weight_ += weights_[child];
    }
    compound_.volume = {static_cast<std::uint64_t>(weight_), kWeightBits - top};
}

void CompoundMaker::find_centre() {
    for (int axis = 0; axis < 3; ++axis) {
        Int128 sum(0);
        for (std::uint32_t child = 0; child < compound_.child_count; ++child) {
            sum = raw_add(
                sum,
                wide_product<Int128>(weights_[child], compound_.children[child].position[axis]));
        }
        compound_.centre[axis] = raw_narrow<std::int32_t>(divide_nearest(sum, weight_));
    }
}

/// A child's own covariance in the given frame, and that of its centre, by weight.
void CompoundMaker::add_covariance(std::uint32_t index, Int128 (&sums)[3][3]) const {
    const CompoundShape& child = compound_.children[index];
    const UnitInertia inertia =
        child.type == ShapeType::hull ? child.hull->inertia : unit_inertia(child.type, child.size);
    const std::int64_t trace =
        (inertia.moment[0].raw() + inertia.moment[1].raw() + inertia.moment[2].raw()) >> 1;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            Int128 own(0);
            for (int axis = 0; axis < 3; ++axis) {
                const std::int64_t turned =
                    std::int64_t{child.rotation[3 * i + axis]} * child.rotation[3 * j + axis];
                own =
                    raw_add(own, wide_product<Int128>(turned, trace - inertia.moment[axis].raw()));
            }
            const std::int64_t from_centre[2] = {
                std::int64_t{child.position[i]} - compound_.centre[i],
                std::int64_t{child.position[j]} - compound_.centre[j]};
            const std::int64_t entry =
                raw_narrow<std::int64_t>(round_shift(own, 2 * kUnitFraction)) +
                from_centre[0] * from_centre[1];
            sums[i][j] = raw_add(sums[i][j], wide_product<Int128>(weights_[index], entry));
        }
    }
}

/// Puts the children into the frame of the principal axes.
void CompoundMaker::turn() {
    Int128 sums[3][3] = {};
    for (std::uint32_t child = 0; child < compound_.child_count; ++child) {
        add_covariance(child, sums);
    }
    Covariance covariance{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            covariance.entry[i][j] = divide_nearest(sums[i][j], weight_);
        }
    }
    store_unit(principal_turn(covariance), compound_.orientation);
    std::int32_t rotation[9];
    rotation_matrix(compound_.orientation, rotation);
    compound_.inertia = moments_about(covariance, rotation);
    const std::int32_t back[9] = {rotation[0],
                                  rotation[3],
                                  rotation[6],
                                  rotation[1],
                                  rotation[4],
                                  rotation[7],
                                  rotation[2],
                                  rotation[5],
                                  rotation[8]};
    for (std::uint32_t index = 0; index < compound_.child_count; ++index) {
        CompoundShape& child = compound_.children[index];
        std::int32_t from_centre[3];
        for (int axis = 0; axis < 3; ++axis) {
            from_centre[axis] = raw_saturate<std::int32_t>(std::int64_t{child.position[axis]} -
                                                           compound_.centre[axis]);
        }
        rotate(back, from_centre, child.position);
        std::int32_t turned[9];
        multiply(back, child.rotation, turned);
        std::copy(turned, turned + 9, child.rotation);
    }
}

/// Bounding radius and arms, from the corners of the children's cores.
void CompoundMaker::measure() {
    const ShapeInstance own{ShapeType::compound, {0, 0, 0}, kIdentityRotation, nullptr, &compound_};
    const auto above = [](const std::int64_t v[3]) {
        UInt128 square{};
        for (int axis = 0; axis < 3; ++axis) {
            square = square + multiply_wide(raw_magnitude(v[axis]), raw_magnitude(v[axis]));
        }
        return static_cast<std::int64_t>(floor_sqrt128(square)) + 1;
    };
    std::int64_t radius = 0;
    std::int64_t arm[3] = {0, 0, 0};
    for (std::uint32_t child = 0; child < compound_.child_count; ++child) {
        const CompoundPart part(own, child);
        ConvexCore core;
        make_core(part.shape, core);
        for (std::uint32_t point = 0; point < core.count; ++point) {
            std::int64_t place[3];
            for (int axis = 0; axis < 3; ++axis) {
                place[axis] = std::int64_t{part.offset[axis]} + core.points[point][axis];
            }
            radius = std::max(radius, above(place) + core.radius);
            for (int axis = 0; axis < 3; ++axis) {
                std::int64_t across[3] = {place[0], place[1], place[2]};
                across[axis] = 0;
                arm[axis] = std::max(arm[axis], above(across) + core.radius);
            }
        }
    }
    compound_.bounding_radius = raw_saturate<std::int32_t>(radius + 1); // the turns round
    for (int axis = 0; axis < 3; ++axis) {
        compound_.arm[axis] = raw_saturate<std::int32_t>(arm[axis]);
    }
}

Result<Compound> CompoundMaker::run() {
    const std::size_t count = definition_.children.size();
    if (count == 0 || count > kCompoundChildrenMax) {
        return Error{"has " + std::to_string(count) + " children; give 1 .. " +
                     std::to_string(kCompoundChildrenMax)};
    }
    compound_.child_count = static_cast<std::uint32_t>(count);
    for (std::size_t index = 0; index < count; ++index) {
        if (std::optional<Error> error = check(index); error) {
            return *error;
        }
        place(index);
    }
    weigh();
    find_centre();
    turn();
    measure();
    return compound_;
}

} // namespace

CompoundPart::CompoundPart(const ShapeInstance& compound, std::uint32_t index) {
    const CompoundShape& child = compound.compound->children[index];
    rotate(compound.rotation, child.position, offset);
    if (child.type == ShapeType::sphere) {
        std::copy(kIdentityRotation, kIdentityRotation + 9, rotation);
    } else {
        multiply(compound.rotation, child.rotation, rotation);
    }
    shape = {child.type, {child.size[0], child.size[1], child.size[2]}, rotation, child.hull};
}

namespace {

/// Q9.22 m, from a point of the compound's frame; 0 inside.
std::int64_t distance_to(const CompoundShape& child, const std::int32_t point[3]) {
    std::int32_t from_centre[3];
    std::int32_t local[3];
    for (int axis = 0; axis < 3; ++axis) {
        from_centre[axis] =
            raw_saturate<std::int32_t>(std::int64_t{point[axis]} - child.position[axis]);
    }
    inverse_rotate(child.rotation, from_centre, local);
    std::int32_t gap[3] = {local[0], local[1], local[2]};
    if (child.type == ShapeType::hull) {
        const ShapeInstance shape{ShapeType::hull, {0, 0, 0}, kIdentityRotation, child.hull};
        BoxFeatures unused;
        NearestPoint nearest{};
        if (!nearest_point(polytope_of(shape, unused), local, nearest)) {
            return 0;
        }
        for (int axis = 0; axis < 3; ++axis) {
            gap[axis] = raw_saturate<std::int32_t>(std::int64_t{local[axis]} - nearest.place[axis]);
        }
    } else if (child.type == ShapeType::box) {
        for (int axis = 0; axis < 3; ++axis) {
            gap[axis] -= clamped(gap[axis], -child.size[axis], child.size[axis]);
        }
    } else if (child.type == ShapeType::capsule) {
        gap[1] -= clamped(gap[1], -child.size[1], child.size[1]);
    }
    const bool is_round = child.type == ShapeType::sphere || child.type == ShapeType::capsule;
    const auto length = static_cast<std::int64_t>(floor_sqrt(squared_length(gap)));
    return std::max<std::int64_t>(length - (is_round ? child.size[0] : 0), 0);
}

} // namespace

bool is_at_seam(const Compound& compound,
                std::uint32_t child,
                const std::int32_t point[3],
                const std::int32_t normal[3]) {
    // A quarter of a metre: long enough to tell normals 0.6 degrees apart by their distances.
    constexpr std::int32_t kWay = 1 << (kLengthFraction - 2);
    constexpr std::int32_t kSlack = kWay >> 14;
    std::int32_t beyond[3];
    for (int axis = 0; axis < 3; ++axis) {
        beyond[axis] =
            raw_saturate<std::int32_t>(std::int64_t{point[axis]} + scale(kWay, normal[axis]));
    }
    for (std::uint32_t other = 0; other < compound.child_count; ++other) {
        if (other == child) {
            continue;
        }
        const std::int64_t before = distance_to(compound.children[other], point);
        if (before <= kLinearSlop &&
            distance_to(compound.children[other], beyond) < before + kWay - kSlack) {
            return true;
        }
    }
    return false;
}

Result<Compound> make_compound(const CompoundDefinition& definition, std::span<const Hull> hulls) {
    return CompoundMaker(definition, hulls).run();
}

} // namespace lockwind
