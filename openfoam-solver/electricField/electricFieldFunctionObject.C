/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "electricFieldFunctionObject.H"
#include "OSspecific.H"
#include "Time.H"
#include "addToRunTimeSelectionTable.H"

namespace Foam
{
namespace functionObjects
{
    defineTypeNameAndDebug(electricField, 0);
    addToRunTimeSelectionTable(functionObject, electricField, dictionary);
}
}

Foam::functionObjects::electricField::electricField
(
    const word& name,
    const Time& runTime,
    const dictionary& dict
)
:
    fvMeshFunctionObject(name, runTime, dict),
    demProcess_(dict.getOrDefault<string>("run", getEnv("AMBERFIELD_RUN"))),
    field_(mesh_, demProcess_),
    pending_(false),
    over_(false)
{
    field_.show(name);
    field_.sendMesh();
}


bool Foam::functionObjects::electricField::read(const dictionary& dict)
{
    return fvMeshFunctionObject::read(dict);
}


void Foam::functionObjects::electricField::answerUpTo(const scalar time)
{
    while (!over_)
    {
        over_ = !pending_ && !demProcess_.wait();
        pending_ = !over_ && demProcess_.request().far.time_s > time;
        if (over_ || pending_)
        {
            return;
        }
        demProcess_.mustBe(AmberfieldQuestion_Field);
        field_.answer();
    }
}


bool Foam::functionObjects::electricField::execute()
{
    const bool wasOver = over_;
    // Both processes count their steps: round-off must not cost one of them
    answerUpTo(time_.value() + 1e-6*time_.deltaTValue());
    if (over_ && !wasOver)
    {
        Info<< type() << ' ' << name() << ": the grains' run is over" << endl;
        time_.stopAt(Time::saWriteNow);
    }
    return true;
}


bool Foam::functionObjects::electricField::write()
{
    return !time_.writeTime() || field_.shownE().write();
}


bool Foam::functionObjects::electricField::end()
{
    if (!over_)
    {
        Info<< type() << ' ' << name() << ": the solver has ended, the grains go on" << endl;
        answerUpTo(GREAT);
    }
    return true;
}


void Foam::functionObjects::electricField::updateMesh(const mapPolyMesh&)
{
    FatalErrorInFunction
        << "the mesh changes; " << type() << ' ' << name() << " needs a mesh that stays"
        << exit(FatalError);
}


void Foam::functionObjects::electricField::movePoints(const polyMesh&)
{
    FatalErrorInFunction
        << "the mesh moves; " << type() << ' ' << name() << " needs a mesh that stays"
        << exit(FatalError);
}
