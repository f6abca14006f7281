// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_FORECAST_H
#define AMBERFIELD_FORECAST_H

#include "pointers.h"

#include <cmath>

namespace amberfield {

// E of every own atom as it is by now, its change per step, and the charge at the last evaluation. The arrays
// go along with the atoms from rank to rank, and into restart files. Every step reads all of them: what no
// step needs does not belong here.
class Forecast : protected LAMMPS_NS::Pointers {
  public:
    // Numbers of an atom
    static constexpr int SIZE = 7;

    explicit Forecast(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}
    ~Forecast() override;
    Forecast(const Forecast &) = delete;
    Forecast &operator=(const Forecast &) = delete;

    void grow(int atoms);
    void copy(int from, int to);
    // An atom that has just come: it has no E yet
    void clear(int i);
    int pack(int i, double *buffer) const;
    int unpack(int i, const double *buffer);

    // Whether the last evaluation knew an atom
    bool knows(int i) const { return !std::isnan(charge[i]); }

    double **e = nullptr;
    double **slope = nullptr;
    // No number for atoms that the last evaluation did not know
    double *charge = nullptr;
};

}    // namespace amberfield

#endif
