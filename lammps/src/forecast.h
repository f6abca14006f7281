// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_FORECAST_H
#define AMBERFIELD_FORECAST_H

#include "pointers.h"

namespace amberfield {

// E of every own atom at the last evaluation, its change per step, and the charge at that time. The arrays
// go along with the atoms from rank to rank, and into restart files.
class Forecast : protected LAMMPS_NS::Pointers {
  public:
    // Numbers of an atom
    static constexpr int SIZE = 8;

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

    // E of an atom so many steps after the last evaluation
    double at(int i, int axis, double age) const { return e[i][axis] + age * slope[i][axis]; }

    double **e = nullptr;
    double **slope = nullptr;
    double *charge = nullptr;
    // 1 for atoms that the last evaluation knew
    double *known = nullptr;
};

}    // namespace amberfield

#endif
