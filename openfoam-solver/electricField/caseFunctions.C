/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "caseFunctions.H"
#include "DynamicList.H"

Foam::caseFunctions::caseFunctions
(
    runClock& time,
    fieldSide& demProcess,
    const bool withoutFlow
)
:
    time_(time),
    demProcess_(demProcess),
    withoutFlow_(withoutFlow),
    names_(names(time)),
    begun_(false),
    isTimeKnown_(false)
{}


Foam::wordList Foam::caseFunctions::names(const Time& time)
{
    DynamicList<word> names;
    dictionary& control = const_cast<dictionary&>(static_cast<const dictionary&>(time.controlDict()));
    if (!control.isDict("functions"))
    {
        return wordList();
    }
    for (entry& each : control.subDict("functions"))
    {
        if (!each.isDict() || !each.dict().getOrDefault("enabled", true))
        {
            continue;
        }
        if (each.dict().getOrDefault<word>("type", word::null) == "electricField")
        {
            Info<< "Function " << each.keyword() << " is left out: this program does its work"
                << nl << endl;
            each.dict().set("enabled", false);
            continue;
        }
        names.append(each.keyword());
    }
    return wordList(names);
}


void Foam::caseFunctions::begin()
{
    if (begun_ || !any())
    {
        return;
    }
    begun_ = true;
    const string before
    (
        demProcess_.doing("an entry below functions of system/controlDict cannot be used")
    );
    time_.functionObjects().start();
    for (const word& name : names_)
    {
        if (time_.functionObjects().findObjectID(name) < 0)
        {
            demProcess_.refuse
            (
                "function " + name + " of system/controlDict cannot be made; the solver's log says"
                " why: mend it, or give it \"enabled false;\""
            );
        }
    }
    demProcess_.doing(before);
}


void Foam::caseFunctions::execute()
{
    if (!begun_)
    {
        return;
    }
    if (!withoutFlow_)
    {
        time_.functionObjects().execute();
        return;
    }
    functionObjectList& functions = time_.functionObjects();
    for (const word& name : names_)
    {
        const label place = leftOut_.found(name) ? -1 : functions.findObjectID(name);
        if (place < 0)
        {
            continue;
        }
        try
        {
            functions[place].execute();
            functions[place].write();
        }
        catch (const error& error)
        {
            leftOut_.insert(name);
            Info<< "Function " << name << " of system/controlDict is left out, no gas flows here: "
                << error.message().c_str() << nl << endl;
        }
    }
}


void Foam::caseFunctions::advanceTo(const scalar then)
{
    if (!isTimeKnown_)
    {
        isTimeKnown_ = true;
        time_.begin(then);
        begin();
    }
    else if (then > time_.value())
    {
        execute();
        time_.advanceTo(then);
    }
}


void Foam::caseFunctions::end()
{
    if (begun_)
    {
        time_.functionObjects().end();
    }
}
