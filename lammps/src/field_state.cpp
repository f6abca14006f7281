// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

// State of "fix amberfield/field" that goes along with atoms, and into restart files.

#include "fix_amberfield_field.h"

#include "atom.h"
#include "comm.h"

#include <cstdint>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using amberfield::Forecast;

namespace {

// Numbers of the fix as a whole, before the text of the parameters
constexpr int NUMBERS = 11;

}    // namespace

void FixAmberfieldField::grow_arrays(int atoms)
{
    forecast_.grow(atoms);
    array_atom = forecast_.e;
}

void FixAmberfieldField::copy_arrays(int from, int to, int)
{
    forecast_.copy(from, to);
}

void FixAmberfieldField::set_arrays(int i)
{
    forecast_.clear(i);
}

int FixAmberfieldField::pack_exchange(int i, double *buffer)
{
    return forecast_.pack(i, buffer);
}

int FixAmberfieldField::unpack_exchange(int i, double *buffer)
{
    return forecast_.unpack(i, buffer);
}

int FixAmberfieldField::pack_restart(int i, double *buffer)
{
    // LAMMPS' custom: the first number is how many there are.
    buffer[0] = maxsize_restart();
    forecast_.pack(i, buffer + 1);
    return maxsize_restart();
}

void FixAmberfieldField::unpack_restart(int nlocal, int nth)
{
    const double *extra = atom->extra[nlocal];
    int place = 0;
    for (int fix = 0; fix < nth; ++fix) place += static_cast<int>(extra[place]);
    forecast_.unpack(nlocal, extra + place + 1);
}

int FixAmberfieldField::size_restart(int)
{
    return maxsize_restart();
}

int FixAmberfieldField::maxsize_restart()
{
    return 1 + Forecast::SIZE;
}

void FixAmberfieldField::write_restart(FILE *file)
{
    if (comm->me != 0) return;
    const std::string parameters = source_.parameters();
    const double numbers[NUMBERS] = {static_cast<double>(interval_.steps),
                                     static_cast<double>(interval_.age),
                                     static_cast<double>(interval_.before),
                                     interval_.evaluations,
                                     interval_.rate,
                                     interval_.squares,
                                     interval_.checked,
                                     evaluated_count_,
                                     measured_,
                                     measured_at_,
                                     strength_};
    const int size = sizeof(numbers) + parameters.size() + 1;
    fwrite(&size, sizeof(int), 1, file);
    fwrite(numbers, sizeof(double), NUMBERS, file);
    fwrite(parameters.c_str(), 1, parameters.size() + 1, file);
}

void FixAmberfieldField::restart(char *buffer)
{
    double numbers[NUMBERS];
    std::memcpy(numbers, buffer, sizeof(numbers));
    interval_.steps = static_cast<long>(numbers[0]);
    interval_.age = static_cast<long>(numbers[1]);
    interval_.before = static_cast<long>(numbers[2]);
    interval_.evaluations = numbers[3];
    interval_.rate = numbers[4];
    interval_.squares = numbers[5];
    interval_.checked = numbers[6];
    evaluated_count_ = numbers[7];
    measured_ = numbers[8];
    measured_at_ = numbers[9];
    strength_ = numbers[10];
    source_.use_parameters(buffer + sizeof(numbers));
    is_restarted_ = true;
}

double FixAmberfieldField::memory_usage()
{
    return static_cast<double>(atom->nmax) * Forecast::SIZE * sizeof(double)
        + static_cast<double>(fresh_.capacity()) * sizeof(double);
}
