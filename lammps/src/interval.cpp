// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "interval.h"

#include <algorithm>
#include <cmath>

using amberfield::Interval;

namespace {

// Error at the end of an interval that is aimed at, over what is allowed: intervals differ
constexpr double AIM = 0.9;
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

void Interval::evaluated(const Check *check, long every, double aim, double most)
{
    evaluations += 1.0;
    if (check && age > 0) {
        squares += check->drift * check->drift * drift_squares(age, before);
        checked += age;
        const bool is_line = before > 0;
        const long chosen = next(*check, aim, most);
        if (is_line) rate = check->drift / growth(age);
        before = age;
        // What held E was off by bounds the first line's error.
        if (!is_line) rate = check->drift / growth(age);
        steps = every == 0 ? chosen : is_line ? every : 1;
    } else {
        steps = 1;
    }
    age = 0;
}

double Interval::error_of_run() const
{
    return checked > 0.0 ? std::sqrt(squares / checked) : 0.0;
}

void Interval::restart()
{
    steps = 1;
    before = 0;
    age = 0;
}

long Interval::next(const Check &check, double aim, double most) const
{
    const double drift = std::max({check.drift, check.drift_of_all, check.largest / WORST, 1e-300});
    const double length = age, share = AIM * aim / (drift / growth(age));
    // The next line has its two evaluations `length` apart.
    const double wanted =
        before == 0 ? share : 0.5 * (std::sqrt(length * length + 4.0 * share) - length);
    // An interval that charges cut short says little about a longer one.
    const double longest = std::max(MOST_GROWTH * length, static_cast<double>(steps));
    const double kept = std::min(std::clamp(wanted, LEAST_GROWTH * length, longest), most);
    return std::max(1L, static_cast<long>(kept));
}
