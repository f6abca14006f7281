// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_INTERVAL_H
#define AMBERFIELD_INTERVAL_H

namespace amberfield {

// Steps between two evaluations of the field, and the error that the steps between them make.
//
// Every evaluation checks the forecast that it replaces: E on the line through the two evaluations before.
// The line errs by 1/2 E'' s (s + S0) after s steps, if they were S0 steps apart. The next interval is that
// over which the RMS error is what is aimed at. amberfield's own DEM does the same (several-rates.md among
// the decisions).
struct Interval {
    // How far fresh E are from the forecast, over the scale of E.
    struct Check {
        double drift = 0.0;           // RMS, weighted with the squares of the charges
        double drift_of_all = 0.0;    // RMS over the atoms
        double largest = 0.0;         // of any atom
    };

    long steps = 1;          // of the interval in progress
    long age = 0;            // steps since the last evaluation
    long before = 0;         // steps between the last two evaluations; 0: E is held
    double evaluations = 0.0;
    double squares = 0.0;    // sum over the checked steps of the squared relative error
    double checked = 0.0;    // checked steps

    bool is_due() const { return age >= steps; }

    // Books an evaluation and chooses the next interval, of at most `most` steps, or of `every` unless that
    // is 0. Without a check nothing was forecast.
    void evaluated(const Check *check, long every, double tolerance, double most);

    // RMS over all checked steps of the relative error of E that comes from not evaluating in each
    double error() const;

    // Forgets the line: what was known is of another bed.
    void restart();

  private:
    long next(const Check &check, double tolerance, double most) const;
};

}    // namespace amberfield

#endif
