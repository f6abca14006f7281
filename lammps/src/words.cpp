// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "words.h"

#include "error.h"

#include <cmath>
#include <cstdlib>

using amberfield::Words;

Words::Words(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) :
    lmp_(lmp), narg_(narg), arg_(arg), place_(3)
{}

std::string Words::next(const std::string &what)
{
    if (!any()) refuse("the words end where " + what + " should stand");
    return arg_[place_++];
}

double Words::number(const std::string &what)
{
    const std::string word = next(what);
    char *end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (word.empty() || *end != '\0' || !std::isfinite(value)) {
        refuse("'" + word + "' is no number; " + what + " should stand there");
    }
    return value;
}

double Words::above(const std::string &what, double bound)
{
    const int place = place_;
    const double value = number(what);
    if (!(value > bound)) {
        const std::string limit = bound == 0.0 ? "0" : std::to_string(bound);
        refuse("'" + std::string(arg_[place]) + "' is too small; " + what + " is above " + limit);
    }
    return value;
}

bool Words::yes(const std::string &what)
{
    const std::string word = next(what);
    if (word != "yes" && word != "no") refuse(word, "yes, no (" + what + ")");
    return word == "yes";
}

void Words::refuse(const std::string &reason) const
{
    lmp_->error->all(FLERR, "fix " + std::string(arg_[0]) + " " + arg_[2] + ": " + reason);
}

void Words::refuse(const std::string &word, const std::string &allowed) const
{
    refuse("unknown word '" + word + "'; allowed are " + allowed);
}
