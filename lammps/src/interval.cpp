// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "interval.h"

#include <algorithm>
#include <cmath>

using amberfield::Interval;

namespace {

// RMS over a long interval of the drift of an extrapolated field, over that at its end: sqrt(31/120)
constexpr double EXTRAPOLATED = 0.508;
// The same of a field that is held: sqrt(1/3)
constexpr double HELD = 0.577;
// RMS error over an interval that is aimed at, over the tolerance; the field itself may take the rest
constexpr double AIM = 0.6;
// Largest difference of any atom that is aimed at, over the RMS difference
constexpr double WORST = 30.0;
// Least and most growth of the interval from one evaluation to the next
constexpr double LEAST_GROWTH = 0.25, MOST_GROWTH = 2.0;

// Sum over the steps s = 1 ... S - 1 of an interval of S steps of the squared drift over that at its end. It
// grows as s (s + S0) after an interval of S0 steps, or as s where S0 is 0.
double drift_squares(double length, double before)
{
    const double last = length - 1.0;
    const double squares = last * length * (2.0 * last + 1.0) / 6.0;
    if (before == 0.0) return squares / (length * length);
    const double cubes = std::pow(0.5 * last * length, 2);
    const double fourths = squares * (3.0 * last * last + 3.0 * last - 1.0) / 5.0;
    return (fourths + 2.0 * before * cubes + before * before * squares)
        / std::pow(length * (length + before), 2);
}

}    // namespace

void Interval::evaluated(const Check *check, long every, double tolerance, double most)
{
    evaluations += 1.0;
    if (check && age > 0) {
        squares += check->drift * check->drift * drift_squares(age, before);
        checked += age;
        steps = every > 0 ? every : next(*check, tolerance, most);
        before = age;
    } else if (every > 0) {
        steps = every;
    }
    age = 0;
}

double Interval::error() const
{
    return checked > 0.0 ? std::sqrt(squares / checked) : 0.0;
}

void Interval::restart()
{
    steps = 1;
    before = 0;
    age = 0;
}

long Interval::next(const Check &check, double tolerance, double most) const
{
    double aim = AIM * tolerance;
    // The more the run has erred so far, the lower the aim.
    if (error() > aim) aim *= std::pow(aim / error(), 2);
    const double drift = std::max({check.drift, check.drift_of_all, check.largest / WORST, 1e-300});
    const double length = age;
    double wanted;
    if (before == 0) {
        wanted = length * std::sqrt(aim / (HELD * drift));
    } else {
        const double curvature = drift / (length * (length + before));
        wanted = 0.5 * (std::sqrt(length * length + 4.0 * aim / (EXTRAPOLATED * curvature)) - length);
    }
    // An interval that charges cut short says little about a longer one.
    const double longest = std::max(MOST_GROWTH * length, static_cast<double>(steps));
    wanted = std::min(std::clamp(wanted, LEAST_GROWTH * length, longest), most);
    return std::max(1L, static_cast<long>(wanted));
}
