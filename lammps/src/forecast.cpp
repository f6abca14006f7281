// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "forecast.h"

#include "memory.h"

#include <algorithm>

using amberfield::Forecast;

Forecast::~Forecast()
{
    memory->destroy(e);
    memory->destroy(slope);
    memory->destroy(charge);
}

void Forecast::grow(int atoms)
{
    memory->grow(e, atoms, 3, "amberfield/field:e");
    memory->grow(slope, atoms, 3, "amberfield/field:slope");
    memory->grow(charge, atoms, "amberfield/field:charge");
}

void Forecast::copy(int from, int to)
{
    double buffer[SIZE];
    pack(from, buffer);
    unpack(to, buffer);
}

void Forecast::clear(int i)
{
    std::fill_n(e[i], 3, 0.0);
    std::fill_n(slope[i], 3, 0.0);
    charge[i] = std::nan("");
}

int Forecast::pack(int i, double *buffer) const
{
    std::copy_n(e[i], 3, buffer);
    std::copy_n(slope[i], 3, buffer + 3);
    buffer[6] = charge[i];
    return SIZE;
}

int Forecast::unpack(int i, const double *buffer)
{
    std::copy_n(buffer, 3, e[i]);
    std::copy_n(buffer + 3, 3, slope[i]);
    charge[i] = buffer[6];
    return SIZE;
}
