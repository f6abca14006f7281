/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "fieldSide.H"
#include "changingPotentials.H"
#include "PstreamReduceOps.H"
#include "stringList.H"
#include "error.H"
#include "foamVersion.H"
#include "OSspecific.H"

#include <cctype>
#include <cfenv>
#include <cstdlib>

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

//- The run that is open
Foam::fieldSide* opened = nullptr;

//- Longest part of a message that is passed on: what follows are lists of all
//  possible words
const std::size_t most = 300;

//- A message in one line
Foam::string oneLine(const Foam::string& message)
{
    Foam::string line;
    for (const char c : message)
    {
        const bool isBlank = std::isspace(c);
        if (!isBlank)
        {
            line += c;
        }
        else if (!line.empty() && line.back() != ' ')
        {
            line += ' ';
        }
    }
    if (line.size() > most)
    {
        line = line.substr(0, most) + " ...";
    }
    while (!line.empty() && line.back() == ' ')
    {
        line.pop_back();
    }
    return line;
}

} // End anonymous namespace


Foam::fieldSide::fieldSide(const string& run)
:
    field_(nullptr),
    request_(),
    potentials_(nullptr),
    cause_("OpenFOAM ended the program")
{
    {
        noTraps quiet;
        open(run);
    }
    opened = this;
    std::atexit(leave);
    checkVersion();
}


Foam::fieldSide::~fieldSide()
{
    opened = nullptr;
    noTraps quiet;
    post_.close();
    amberfield_field_close(field_);
}


void Foam::fieldSide::open(const string& run)
{
    const uint32_t rank = Pstream::parRun() ? uint32_t(Pstream::myProcNo()) : 0;
    const uint32_t ranks = Pstream::parRun() ? uint32_t(Pstream::nProcs()) : 1;
    const auto outcome = [&]
    {
        const bool failed = field_ && amberfield_field_error(field_)[0] != '\0';
        return failed ? AmberfieldStatus_Failed : AmberfieldStatus_Ok;
    };
    string name(run);
    if (Pstream::parRun())
    {
        if (run.empty())
        {
            // Another machine may have a run that waits too: the first rank's
            // is meant
            if (Pstream::master())
            {
                field_ = amberfield_field_open(run.c_str(), rank, ranks);
            }
            check(outcome());
            name = Pstream::master() ? amberfield_field_run(field_) : "";
            Pstream::scatter(name);
        }
        post_.find(name);
    }
    if (!field_)
    {
        field_ = post_.isHere()
          ? amberfield_field_open(name.c_str(), rank, ranks)
          : amberfield_field_open_distant(name.c_str(), rank, ranks);
    }
    check(outcome());
    check(post_.open(name));
}


void Foam::fieldSide::checkVersion()
{
    Info<< "Built for OpenFOAM v" << OPENFOAM << ", runs with v" << foamVersion::api << nl << endl;
    if (foamVersion::api != OPENFOAM)
    {
        refuse
        (
            "this program was built for OpenFOAM v" + Foam::name(OPENFOAM)
          + ", but the libraries that it finds are of v" + Foam::name(foamVersion::api)
          + "; build it for these, or source the environment of the other"
        );
    }
}


int Foam::fieldSide::lead(const std::function<void()>& program)
{
    FatalError.throwExceptions();
    FatalIOError.throwExceptions();
    try
    {
        program();
        return 0;
    }
    catch (const IOerror& error)
    {
        tellOf(error);
        Perr<< nl << error << endl;
    }
    catch (const error& error)
    {
        tellOf(error);
        Perr<< nl << error << endl;
    }
    Pstream::exit(1);
    return 1;
}


Foam::string Foam::fieldSide::doing(const string& cause)
{
    const string before(cause_);
    cause_ = cause;
    return before;
}


void Foam::fieldSide::tell(const string& reason, const bool isInput)
{
    if (!field_)
    {
        return;
    }
    noTraps quiet;
    if (isInput)
    {
        amberfield_field_refuse(field_, reason.c_str());
    }
    else
    {
        amberfield_field_fail(field_, reason.c_str());
    }
    post_.close();
    amberfield_field_close(field_);
    field_ = nullptr;
}


void Foam::fieldSide::tellOf(const IOerror& error)
{
    if (!Pstream::master())
    {
        // The first rank knows the file; the others had their text of it
        Foam::sleep(1);
    }
    string place(error.ioFileName());
    if (!place.empty() && error.ioStartLineNumber() > 0)
    {
        place += ", line " + Foam::name(error.ioStartLineNumber());
    }
    tell(oneLine(error.message()) + (place.empty() ? place : " (" + place + ')'), true);
}


void Foam::fieldSide::tellOf(const error& error)
{
    // Before the mesh is sent it is a fault of the case for the DEM process
    tell(oneLine(error.message()), false);
}


void Foam::fieldSide::leave()
{
    if (!opened)
    {
        return;
    }
    if (!FatalIOError.message().empty())
    {
        opened->tellOf(FatalIOError);
    }
    else if (!FatalError.message().empty())
    {
        opened->tellOf(FatalError);
    }
    else
    {
        opened->tell(opened->cause_ + "; the log of the field solver says more", true);
    }
}


void Foam::fieldSide::check(const AmberfieldStatus status)
{
    const bool failed = status == AmberfieldStatus_Failed;
    if (!returnReduce(failed, orOp<bool>()))
    {
        return;
    }
    // All know the reason: ranks on other machines cannot tell it
    stringList reasons(Pstream::nProcs());
    if (failed)
    {
        string& own = reasons[Pstream::myProcNo()];
        own = post_.reason().empty() ? string(amberfield_field_error(field_)) : post_.reason();
        own += post_.isFound() ? "" : "; no rank is on the machine of the DEM process";
    }
    Pstream::gatherList(reasons);
    Pstream::scatterList(reasons);
    string reason("another rank failed");
    for (const string& known : reasons)
    {
        if (!known.empty())
        {
            reason = known;
            break;
        }
    }
    // No destructor runs on the way out
    tell(reason, false);
    FatalErrorInFunction << reason << exit(FatalError);
}


void Foam::fieldSide::sent(const AmberfieldStatus status)
{
    check(status);
    if (post_.isNeeded())
    {
        check(post_.carry(field_));
    }
}


void Foam::fieldSide::sendMesh
(
    const meshDescription& mesh,
    const changingPotentials* potentials
)
{
    potentials_ = potentials;
    noTraps quiet;
    const AmberfieldMesh view(mesh.view());
    sent(amberfield_field_send_mesh(field_, &view));
}


bool Foam::fieldSide::wait()
{
    AmberfieldStatus status = AmberfieldStatus_Ok;
    do
    {
        noTraps quiet;
        status = post_.wait(field_, request_);
        check(status);
    }
    while (status == AmberfieldStatus_Ok && replyPotentials());
    return status == AmberfieldStatus_Ok;
}


bool Foam::fieldSide::replyPotentials()
{
    if (request_.question != AmberfieldQuestion_Potentials)
    {
        return false;
    }
    scalarField times(label(request_.times));
    {
        noTraps quiet;
        check(amberfield_field_times(field_, times.data(), uint64_t(times.size())));
    }
    const scalarField values(potentials_ ? potentials_->at(times) : scalarField());
    {
        noTraps quiet;
        sent(amberfield_field_reply_potentials(field_, values.cdata(), uint64_t(values.size())));
    }
    return true;
}


void Foam::fieldSide::mustBe(const AmberfieldQuestion question)
{
    if (request_.question != question)
    {
        refuse
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
    sent(amberfield_field_reply_flow(field_, &flow));
}


void Foam::fieldSide::replyState(const scalarField& state)
{
    noTraps quiet;
    sent(amberfield_field_reply_state(field_, state.cdata(), uint64_t(state.size())));
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
    sent(amberfield_field_reply(field_, &far));
}


void Foam::fieldSide::refuse(const string& reason)
{
    tell(reason, true);
    FatalErrorInFunction << reason << exit(FatalError);
}
