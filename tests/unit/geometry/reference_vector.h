#pragma once

#include <cmath>

namespace lockwind::reference {

struct Vec {
    double component[3];

    double operator[](int axis) const { return component[axis]; }
};

inline Vec operator+(const Vec& a, const Vec& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec operator-(const Vec& a, const Vec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec operator*(const Vec& a, double factor) {
    return {a[0] * factor, a[1] * factor, a[2] * factor};
}
inline double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec& a) {
    return std::sqrt(dot(a, a));
}

} // namespace lockwind::reference
