// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "units.h"

#include "error.h"
#include "update.h"

#include <cstring>
#include <string>

namespace {

// Speed of light [m/s], by which Gaussian units of charge and field are defined.
constexpr double LIGHT = 299792458.0;

}    // namespace

amberfield::Units amberfield::Units::of(LAMMPS_NS::LAMMPS *lmp, const char *fix)
{
    const char *style = lmp->update->unit_style;
    if (std::strcmp(style, "si") == 0) return {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    if (std::strcmp(style, "cgs") == 0) {
        return {1e-2, 0.1 / LIGHT, 1e-4 * LIGHT, 1e-6 * LIGHT, 1e-7, 0.1};
    }
    const std::string me = "fix " + std::string(fix) + ": ";
    lmp->error->all(FLERR, me + "units " + style + " are not possible; allowed are si, cgs");
}
