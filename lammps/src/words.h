// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_WORDS_H
#define AMBERFIELD_WORDS_H

#include "lammps.h"
#include "lmptype.h"

#include <string>
#include <vector>

namespace amberfield {

// The words of a fix command, read one after another. What is wrong ends the run with a message that names
// the word and what is allowed.
class Words {
  public:
    // Words behind "fix ID group style".
    Words(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);

    bool any() const { return place_ < narg_; }

    // The next word, which must be there: what it is, as messages say it.
    std::string next(const std::string &what);

    // A number, at least or above a bound.
    double number(const std::string &what);
    double above(const std::string &what, double bound);

    // "yes" or "no"
    bool yes(const std::string &what);

    [[noreturn]] void refuse(const std::string &reason) const;
    [[noreturn]] void refuse(const std::string &word, const std::string &allowed) const;

  private:
    LAMMPS_NS::LAMMPS *lmp_;
    int narg_;
    char **arg_;
    int place_;
};

// Id of a charge that is no atom's but a wall's.
constexpr LAMMPS_NS::tagint OF_WALL = -1;

// A message of the library in the words of the fix: atoms by their ids, of which there is one for each index,
// and settings as the fix names them.
std::string message_of_library(std::string message, const std::vector<LAMMPS_NS::tagint> &ids);

}    // namespace amberfield

#endif
