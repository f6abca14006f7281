// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_INTERVAL_H
#define AMBERFIELD_INTERVAL_H

namespace amberfield {

// Steps between two evaluations of the field, and the error that the steps between them make.
//
// Every evaluation checks the forecast that it replaces: E on the line through the two evaluations before.
// The line errs by 1/2 E'' s (s + S0) after s steps, if they were S0 steps apart. The next interval ends
// where that is what is aimed at. amberfield's own DEM does nearly the same (several-rates.md among the
// decisions).
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
    double rate = 0.0;       // of the last check: drift over growth(); 0: nothing was checked yet
    double squares = 0.0;    // sum over the checked steps of the squared relative error
    double checked = 0.0;    // checked steps

    bool is_due() const { return age >= steps; }

    // Books an evaluation and chooses the next interval: one of at most `most` steps at the end of which
    // the forecast errs by `aim`, or of `every` steps unless that is 0. The first intervals are short: a
    // line needs two evaluations, and its error three.
    void evaluated(const Check *check, long every, double aim, double most);

    // Relative error of E at present that comes from not evaluating in every step, RMS over the atoms
    double error() const { return rate * growth(age); }

    // RMS of that error over all checked steps
    double error_of_run() const;

    // Forgets the line: what was known is of another bed.
    void restart();

  private:
    // How the error of the forecast grows with the steps, on the line or with E held
    double growth(double length) const { return before > 0 ? length * (length + before) : length; }
    long next(const Check &check, double aim, double most) const;
};

}    // namespace amberfield

#endif
