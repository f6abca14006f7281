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

std::string amberfield::message_of_library(std::string message,
                                           const std::vector<LAMMPS_NS::tagint> &ids)
{
    const std::string grain = "grain at index ";
    const size_t place = message.find(grain);
    if (place != std::string::npos) {
        const size_t from = place + grain.size(), to = message.find_first_not_of("0123456789", from);
        const size_t index = std::strtoul(message.c_str() + from, nullptr, 10);
        const bool is_atom = index < ids.size() && ids[index] != OF_WALL;
        const std::string name = is_atom ? "atom " + std::to_string(ids[index]) : "charge on a wall";
        message.replace(place, (to == std::string::npos ? message.size() : to) - place, name);
    }
    const char *const settings[][2] = {
        {"set electric_field.neutralising_background = true", "give background yes"},
        {"electric_field.tolerance", "tolerance"},
    };
    for (const auto &setting : settings) {
        const size_t found = message.find(setting[0]);
        if (found != std::string::npos) message.replace(found, std::string(setting[0]).size(), setting[1]);
    }
    return message;
}

void Words::refuse(const std::string &reason) const
{
    lmp_->error->all(FLERR, "fix " + std::string(arg_[0]) + " " + arg_[2] + ": " + reason);
}

void Words::refuse(const std::string &word, const std::string &allowed) const
{
    refuse("unknown word '" + word + "'; allowed are " + allowed);
}
