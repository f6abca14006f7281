// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

// Entry of the plugin: checks that it fits the program that loads it, then tells its styles.

#include "fix_amberfield_charge.h"
#include "fix_amberfield_field.h"
#include "lammpsplugin.h"
#include "load_checks.h"

#include "lammps.h"

using namespace LAMMPS_NS;

namespace {

void *make_field(LAMMPS *lmp, int narg, char **arg)
{
    return new FixAmberfieldField(lmp, narg, arg);
}

void *make_charge(LAMMPS *lmp, int narg, char **arg)
{
    return new FixAmberfieldCharge(lmp, narg, arg);
}

}    // namespace

// Called by LAMMPS' command "plugin load".
extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
    auto *lammps = static_cast<LAMMPS *>(lmp);
    amberfield::check_program(lammps);

    auto tell = reinterpret_cast<lammpsplugin_regfunc>(regfunc);
    lammpsplugin_t plugin;
    plugin.version = lammps->version;
    plugin.style = "fix";
    plugin.author = "amberfield";
    plugin.handle = handle;

    plugin.name = "amberfield/field";
    plugin.info = "electric field of charged grains in a box with walls";
    plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&make_field);
    tell(&plugin, lmp);

    plugin.name = "amberfield/charge";
    plugin.info = "charge transfer at contacts of grains";
    plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&make_charge);
    tell(&plugin, lmp);
}
