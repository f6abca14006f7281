/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later

Application
    selfTest

Description
    Whether this build computes what it says. OpenFOAM's field loops are marked
    restrict and run in place on temporaries that are used again: a compiler
    that takes them at their word makes wrong products of tensors and vectors
    unless the keyword is defined away.

\*---------------------------------------------------------------------------*/

#include "IOstreams.H"
#include "messageStream.H"
#include "tensorField.H"
#include "vectorField.H"

using namespace Foam;

namespace
{

int failures = 0;

void expect(const char* what, const scalar error)
{
    if (!(error < 1e-12))
    {
        Info<< "FAILED: " << what << ", error " << error << endl;
        ++failures;
    }
}

} // End anonymous namespace


int main()
{
    const label n = 1003;
    tensorField A(n);
    vectorField b(n);
    vectorField c(n);
    vectorField product(n);
    vectorField cross(n);
    forAll(b, i)
    {
        const scalar x = scalar(i)/n;
        A[i] = tensor(1 + x, 0.3, -x, 0.2*x, 2 - x, 0.1, x*x, -0.4, 1.5);
        b[i] = vector(x, 1 - x, 0.5 + x*x);
        c[i] = vector(1, -x, 2*x);
        for (direction row = 0; row < 3; ++row)
        {
            product[i][row] = 0;
            for (direction column = 0; column < 3; ++column)
            {
                product[i][row] += A[i](row, column)*b[i][column];
            }
        }
        cross[i] = vector
        (
            b[i].y()*c[i].z() - b[i].z()*c[i].y(),
            b[i].z()*c[i].x() - b[i].x()*c[i].z(),
            b[i].x()*c[i].y() - b[i].y()*c[i].x()
        );
    }

    // Temporaries that are used again as results
    tmp<vectorField> reused(A & (b + vectorField(n, Zero)));
    expect("tensor times vector", max(mag(reused() - product)));
    tmp<vectorField> twice((b + vectorField(n, Zero)) ^ c);
    expect("cross product", max(mag(twice() - cross)));

    // In place
    vectorField inPlace(b);
    inPlace = A & inPlace;
    expect("tensor times vector in place", max(mag(inPlace - product)));
    inPlace = b;
    inPlace = inPlace ^ c;
    expect("cross product in place", max(mag(inPlace - cross)));

    if (failures == 0)
    {
        Info<< "self-test passed" << endl;
    }
    return failures;
}
