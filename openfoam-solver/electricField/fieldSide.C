/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "fieldSide.H"
#include "PstreamReduceOps.H"
#include "error.H"

#include <cfenv>

static_assert(sizeof(Foam::scalar) == sizeof(double), "build OpenFOAM in double precision");

namespace
{

//- No floating-point traps inside
class noTraps
{
    std::fenv_t environment_;

public:

    noTraps()
    {
        std::feholdexcept(&environment_);
    }

    ~noTraps()
    {
        std::fesetenv(&environment_);
    }
};

} // End anonymous namespace


Foam::fieldSide::fieldSide(const string& run)
:
    field_(nullptr),
    request_()
{
    noTraps quiet;
    field_ = amberfield_field_open
    (
        run.c_str(),
        uint32_t(Pstream::parRun() ? Pstream::myProcNo() : 0),
        uint32_t(Pstream::parRun() ? Pstream::nProcs() : 1)
    );
    const bool failed = amberfield_field_error(field_)[0] != '\0';
    check(failed ? AmberfieldStatus_Failed : AmberfieldStatus_Ok);
}


Foam::fieldSide::~fieldSide()
{
    noTraps quiet;
    amberfield_field_close(field_);
}


void Foam::fieldSide::check(const AmberfieldStatus status)
{
    const bool failed = status == AmberfieldStatus_Failed;
    const string reason(failed ? amberfield_field_error(field_) : "");
    if (failed)
    {
        amberfield_field_fail(field_, reason.c_str());
    }
    if (returnReduce(failed, orOp<bool>()))
    {
        // No destructor runs on the way out
        amberfield_field_close(field_);
        field_ = nullptr;
        FatalErrorInFunction
            << (failed ? reason : string("another rank failed"))
            << exit(FatalError);
    }
}


void Foam::fieldSide::sendMesh(const meshDescription& mesh)
{
    noTraps quiet;
    const AmberfieldMesh view(mesh.view());
    check(amberfield_field_send_mesh(field_, &view));
}


bool Foam::fieldSide::wait()
{
    noTraps quiet;
    const AmberfieldStatus status = amberfield_field_wait(field_, &request_);
    check(status);
    return status == AmberfieldStatus_Ok;
}


void Foam::fieldSide::mustBe(const AmberfieldQuestion question)
{
    if (request_.question != question)
    {
        fail
        (
            "this program solves for the electric field only; a gas that flows needs"
            " amberPimpleFoam"
        );
    }
}


void Foam::fieldSide::density(scalarField& rho)
{
    noTraps quiet;
    check(amberfield_field_density(field_, rho.data(), uint64_t(rho.size())));
}


Foam::tmp<Foam::scalarField> Foam::fieldSide::boundary(const label faces)
{
    noTraps quiet;
    tmp<scalarField> values(new scalarField(faces));
    check(amberfield_field_boundary(field_, values.ref().data(), uint64_t(faces)));
    return values;
}


void Foam::fieldSide::guess(scalarField& V)
{
    noTraps quiet;
    check(amberfield_field_guess(field_, V.data(), uint64_t(V.size())));
}


void Foam::fieldSide::grains
(
    scalarField& voidFraction,
    scalarField& drag,
    vectorField& source
)
{
    noTraps quiet;
    check
    (
        amberfield_field_grains
        (
            field_,
            voidFraction.data(),
            drag.data(),
            reinterpret_cast<scalar*>(source.data()),
            uint64_t(voidFraction.size())
        )
    );
}


void Foam::fieldSide::reply(const AmberfieldFlow& flow)
{
    noTraps quiet;
    check(amberfield_field_reply_flow(field_, &flow));
}


void Foam::fieldSide::replyState(const scalarField& state)
{
    noTraps quiet;
    check(amberfield_field_reply_state(field_, state.cdata(), uint64_t(state.size())));
}


void Foam::fieldSide::takeState(scalarField& state)
{
    noTraps quiet;
    check(amberfield_field_state(field_, state.data(), uint64_t(state.size())));
}


void Foam::fieldSide::reply
(
    const scalarField& V,
    const vectorField& E,
    const label iterations,
    const scalar residual,
    const scalar seconds
)
{
    noTraps quiet;
    AmberfieldFar far;
    far.cells = uint64_t(V.size());
    far.potential = V.cdata();
    far.e = reinterpret_cast<const scalar*>(E.cdata());
    far.iterations = uint64_t(iterations);
    far.residual = residual;
    far.seconds = seconds;
    check(amberfield_field_reply(field_, &far));
}


void Foam::fieldSide::fail(const string& reason)
{
    noTraps quiet;
    amberfield_field_fail(field_, reason.c_str());
    amberfield_field_close(field_);
    field_ = nullptr;
    FatalErrorInFunction << reason << exit(FatalError);
}
