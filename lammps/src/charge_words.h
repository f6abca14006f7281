// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_CHARGE_WORDS_H
#define AMBERFIELD_CHARGE_WORDS_H

#include "units.h"
#include "words.h"

#include "lammps.h"

#include <string>
#include <vector>

namespace amberfield {

// A wall that takes charge: a region, which a fix wall/gran/region makes a wall of.
struct ChargingWall {
    std::string region;
    double work;           // work function [eV]
    bool keeps = false;    // an insulator, which keeps charge where grains left it
};

// What the words of "fix amberfield/charge" ask for, in SI. Arrays are by atom type, from 1.
struct ChargeWords {
    std::vector<double> work;    // work functions [eV]
    std::vector<double> young, young_real, poisson;
    double cutoff = 0.0;          // [m]
    double breakdown = 0.0;       // [V/m]; 0: none
    double permittivity = 0.0;    // 0: that of the field, or 1
    std::vector<ChargingWall> walls;

    static ChargeWords read(Words words, const Units &units, LAMMPS_NS::LAMMPS *lmp);

    bool any_keeps() const;

    // Factor of the contact area of two types. A wall is as a grain of the same type.
    double area_factor(int a, int b) const;

  private:
    int type(Words &words, LAMMPS_NS::LAMMPS *lmp) const;
    void read_wall(Words &words);
    void check(Words &words) const;
};

}    // namespace amberfield

#endif
