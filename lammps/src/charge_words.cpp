// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "charge_words.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "modify.h"

#include "amberfield.h"

#include <algorithm>
#include <cstdlib>

using amberfield::ChargeWords;
using amberfield::Words;

namespace {

const char *const ALLOWED = "work, cutoff, wall, breakdown, permittivity, young, young_real, poisson";
// No work function was given
constexpr double NONE = -1.0;
// Poisson's ratio where none is given; with equal ones of both bodies it cancels
constexpr double POISSON = 0.3;

}    // namespace

ChargeWords ChargeWords::read(Words words, const Units &units, LAMMPS_NS::LAMMPS *lmp)
{
    ChargeWords read;
    const int types = lmp->atom->ntypes;
    read.work.assign(types + 1, NONE);
    read.young.assign(types + 1, 0.0);
    read.young_real.assign(types + 1, 0.0);
    read.poisson.assign(types + 1, POISSON);
    while (words.any()) {
        const std::string word = words.next("a word");
        if (word == "work") {
            const int type = read.type(words, lmp);
            read.work[type] = words.above("the work function [eV]", 0.0);
        } else if (word == "cutoff") {
            read.cutoff = units.length * words.above("the cut-off length of the transfer", 0.0);
        } else if (word == "breakdown") {
            read.breakdown = units.field * words.above("the field at which the medium breaks down", 0.0);
        } else if (word == "permittivity") {
            read.permittivity = words.number("the relative permittivity");
            if (read.permittivity < 1.0) words.refuse("the relative permittivity is 1 or more");
        } else if (word == "young") {
            const int type = read.type(words, lmp);
            read.young[type] = units.pressure * words.above("Young's modulus of the pair style", 0.0);
        } else if (word == "young_real") {
            const int type = read.type(words, lmp);
            read.young_real[type] = units.pressure * words.above("Young's modulus of the material", 0.0);
        } else if (word == "poisson") {
            const int type = read.type(words, lmp);
            read.poisson[type] = words.number("Poisson's ratio");
            if (!(read.poisson[type] >= 0.0 && read.poisson[type] <= 0.5)) {
                words.refuse("Poisson's ratio is between 0 and 0.5");
            }
        } else if (word == "wall") {
            read.read_wall(words);
            if (!lmp->domain->get_region_by_id(read.walls.back().region)) {
                const std::string name = read.walls.back().region;
                LAMMPS_NS::Fix *fix = lmp->modify->get_fix_by_id(name);
                words.refuse(fix ? "wall " + name + " is a fix of style " + fix->style
                                     + ", whose geometry cannot be known; make it a region with fix "
                                       "wall/gran/region, and give the region's name"
                                 : "wall " + name + " is no region; define it first, and use it in a fix "
                                                    "wall/gran/region");
            }
        } else {
            words.refuse(word, ALLOWED);
        }
    }
    read.check(words);
    return read;
}

int ChargeWords::type(Words &words, LAMMPS_NS::LAMMPS *lmp) const
{
    const std::string word = words.next("an atom type");
    char *end = nullptr;
    const long type = std::strtol(word.c_str(), &end, 10);
    if (*end != '\0' || type < 1 || type > lmp->atom->ntypes) {
        words.refuse("'" + word + "' is no atom type; allowed are 1 to " + std::to_string(lmp->atom->ntypes));
    }
    return static_cast<int>(type);
}

void ChargeWords::read_wall(Words &words)
{
    ChargingWall wall;
    wall.region = words.next("the name of a region");
    const std::string work = words.next("work");
    if (work != "work") words.refuse(work, "work, then the wall's work function [eV]");
    wall.work = words.above("the wall's work function [eV]", 0.0);
    const std::string kind = words.next("grounded or insulating");
    if (kind != "grounded" && kind != "insulating") words.refuse(kind, "grounded, insulating");
    wall.keeps = kind == "insulating";
    walls.push_back(wall);
}

bool ChargeWords::any_keeps() const
{
    return std::any_of(walls.begin(), walls.end(), [](const ChargingWall &wall) { return wall.keeps; });
}

void ChargeWords::check(Words &words) const
{
    if (cutoff == 0.0) words.refuse("cutoff is missing, the length over which charge passes, such as 5e-7 m");
    for (size_t type = 1; type < work.size(); ++type) {
        const std::string name = std::to_string(type);
        if (work[type] == NONE) words.refuse("work " + name + " is missing, the work function of the type");
        if (young_real[type] > 0.0 && young[type] == 0.0) {
            words.refuse("young_real " + name + " needs young " + name
                         + ", the modulus of the pair style, which cannot be known");
        }
    }
}

double ChargeWords::area_factor(int a, int b) const
{
    if (young_real[a] == 0.0 && young_real[b] == 0.0) return 1.0;
    // Without a modulus of its own the other body counts as one of the same kind.
    const int of_a = young[a] > 0.0 ? a : b, of_b = young[b] > 0.0 ? b : a;
    const auto real = [this](int type) { return young_real[type] > 0.0 ? young_real[type] : young[type]; };
    const double soft[2] = {young[of_a], young[of_b]}, hard[2] = {real(of_a), real(of_b)};
    const double ratio[2] = {poisson[of_a], poisson[of_b]};
    return amberfield_area_correction(soft, hard, ratio);
}
