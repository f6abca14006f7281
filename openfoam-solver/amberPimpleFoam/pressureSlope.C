/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "pressureSlope.H"
#include "extrapolatedCalculatedFvPatchFields.H"
#include "fvc.H"
#include "gaussGrad.H"
#include "linear.H"

namespace
{

//- Resistance that counts beside that of grains, over the rate at which the
//  gas passes a cell: where it is the larger one, p follows no grains
const Foam::scalar besides = 0.03;

//- Distance from the line between centres, over the square root of the face,
//  from which on a face is aside
const Foam::scalar mostAside = 1e-6;

//- How often pressures at faces and the gradients that they depend on are
//  brought together
const Foam::label passes = 3;

} // End anonymous namespace


Foam::pressureSlope::pressureSlope(const volScalarField& p, const volVectorField& U)
:
    p_(p),
    U_(U),
    values_
    (
        IOobject("slope(p)", p.mesh().time().timeName(), p.mesh()),
        p.mesh(),
        dimensionedVector("slope", p.dimensions()/dimLength, Zero),
        extrapolatedCalculatedFvPatchVectorField::typeName
    ),
    aside_
    (
        IOobject("aside", p.mesh().time().timeName(), p.mesh()),
        p.mesh(),
        dimensionedVector("aside", dimLength, Zero)
    ),
    bent_
    (
        IOobject("bent", p.mesh().time().timeName(), p.mesh()),
        p.mesh(),
        dimensionedTensor("bent", dimless, Zero),
        extrapolatedCalculatedFvPatchTensorField::typeName
    )
{
    const fvMesh& mesh = p.mesh();
    const vectorField& C = mesh.C();
    const surfaceScalarField& w = mesh.surfaceInterpolation::weights();
    const labelUList& owner = mesh.owner();
    const labelUList& neighbour = mesh.neighbour();

    forAll(owner, facei)
    {
        const vector met(w[facei]*C[owner[facei]] + (1 - w[facei])*C[neighbour[facei]]);
        aside_[facei] = mesh.Cf()[facei] - met;
    }
    scalar most = gMax(scalarField(mag(aside_.primitiveField())/sqrt(mesh.magSf().primitiveField())));
    forAll(aside_.boundaryField(), patchi)
    {
        const fvPatch& patch = mesh.boundary()[patchi];
        vectorField& aside = aside_.boundaryFieldRef()[patchi];
        const vectorField from(patch.Cf() - patch.Cn());
        if (patch.coupled())
        {
            aside = from - (1 - w.boundaryField()[patchi])*patch.delta();
        }
        else
        {
            const vectorField n(patch.nf());
            aside = from - n*(n & from);
        }
        forAll(aside, facei)
        {
            most = max(most, mag(aside[facei])/sqrt(patch.magSf()[facei]));
        }
    }
    reduce(most, maxOp<scalar>());
    isAside_ = most > mostAside;

    const surfaceVectorField& Sf = mesh.Sf();
    tensorField sum(mesh.nCells(), Zero);
    forAll(owner, facei)
    {
        sum[owner[facei]] += Sf[facei]*(mesh.Cf()[facei] - C[owner[facei]]);
        sum[neighbour[facei]] -= Sf[facei]*(mesh.Cf()[facei] - C[neighbour[facei]]);
    }
    forAll(mesh.boundaryMesh(), patchi)
    {
        const polyPatch& patch = mesh.boundaryMesh()[patchi];
        const labelUList& cells = patch.faceCells();
        forAll(cells, i)
        {
            sum[cells[i]] += patch.faceAreas()[i]*(patch.faceCentres()[i] - C[cells[i]]);
        }
    }
    bent_.primitiveFieldRef() = inv(tensorField(sum/mesh.V()));
    bent_.correctBoundaryConditions();

    scalar tilt = gMax(scalarField(mag(mesh.nonOrthCorrectionVectors().primitiveField())));
    forAll(mesh.boundary(), patchi)
    {
        if (mesh.boundary()[patchi].coupled())
        {
            for (const vector& v : mesh.nonOrthCorrectionVectors().boundaryField()[patchi])
            {
                tilt = max(tilt, mag(v));
            }
        }
    }
    isOblique_ = returnReduce(tilt, maxOp<scalar>()) > mostAside;
}


Foam::tmp<Foam::surfaceScalarField> Foam::pressureSlope::weights
(
    const volScalarField& resistance,
    const surfaceScalarField& phi
) const
{
    const fvMesh& mesh = p_.mesh();
    const surfaceScalarField& w = mesh.surfaceInterpolation::weights();
    volScalarField passing
    (
        IOobject("passing", mesh.time().timeName(), mesh),
        mesh,
        dimensionedScalar("passing", dimless/dimTime, SMALL),
        extrapolatedCalculatedFvPatchScalarField::typeName
    );
    passing.primitiveFieldRef() += 0.5*besides*fvc::surfaceSum(mag(phi))().primitiveField()/mesh.V();
    passing.correctBoundaryConditions();
    // The same for both cells, so that a gas without grains has the usual gradient
    const surfaceScalarField same(linearInterpolate(passing));

    tmp<surfaceScalarField> weights(new surfaceScalarField("weights", w));
    const auto weight = [](const scalar w, const scalar here, const scalar there)
    {
        return there*w/(here*(1 - w) + there*w);
    };
    scalarField& inner = weights.ref().primitiveFieldRef();
    forAll(inner, facei)
    {
        const scalar here = resistance[mesh.owner()[facei]] + same[facei];
        const scalar there = resistance[mesh.neighbour()[facei]] + same[facei];
        inner[facei] = weight(w[facei], here, there);
    }
    forAll(resistance.boundaryField(), patchi)
    {
        const fvPatchScalarField& pR = resistance.boundaryField()[patchi];
        if (pR.coupled())
        {
            const scalarField here(pR.patchInternalField() + same.boundaryField()[patchi]);
            const scalarField there(pR.patchNeighbourField() + same.boundaryField()[patchi]);
            scalarField& of = weights.ref().boundaryFieldRef()[patchi];
            forAll(of, facei)
            {
                of[facei] = weight(of[facei], here[facei], there[facei]);
            }
        }
    }
    return weights;
}


Foam::tmp<Foam::surfaceScalarField> Foam::pressureSlope::oblique() const
{
    const fvMesh& mesh = p_.mesh();
    return mesh.magSf()*(mesh.nonOrthCorrectionVectors() & linearInterpolate(values_));
}


void Foam::pressureSlope::update
(
    const volScalarField& resistance,
    const volScalarField& acts,
    const volScalarField& drag,
    const volVectorField& source,
    const surfaceScalarField& phi
)
{
    const surfaceScalarField between
    (
        surfaceInterpolationScheme<scalar>::interpolate(p_, weights(resistance, phi))
    );
    for (label pass = 0; pass < (isAside_ ? passes : 1); ++pass)
    {
        surfaceScalarField pf("pf", between);
        if (isAside_)
        {
            pf += aside_ & linearInterpolate(values_);
        }
        forAll(p_.boundaryField(), patchi)
        {
            const fvPatchScalarField& pp = p_.boundaryField()[patchi];
            const fvPatch& patch = pp.patch();
            if (pp.coupled())
            {
                continue;
            }
            if (pp.fixesValue())
            {
                pf.boundaryFieldRef()[patchi] = pp;
                continue;
            }
            const vectorField n(patch.nf());
            const vectorField s(source.boundaryField()[patchi].patchInternalField());
            const scalarField K(drag.boundaryField()[patchi].patchInternalField());
            const scalarField a(acts.boundaryField()[patchi].patchInternalField());
            const scalarField across(((n & s) - K*phi.boundaryField()[patchi]/patch.magSf())/a);
            const vectorField along(values_.boundaryField()[patchi].patchInternalField());
            pf.boundaryFieldRef()[patchi] =
                pp.patchInternalField()
              + across*(n & (patch.Cf() - patch.Cn()))
              + (aside_.boundaryField()[patchi] & along);
        }
        values_ = bent_ & fv::gaussGrad<scalar>::gradf(pf, "slope(p)");
        values_.correctBoundaryConditions();
    }
}
