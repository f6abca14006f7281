/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "rankPost.H"
#include "DynamicList.H"
#include "Pstream.H"
#include "UIPstream.H"
#include "UOPstream.H"

#include <algorithm>
#include <chrono>
#include <thread>

namespace
{

//- Mark of our messages among OpenFOAM's
const int tag = 5271;

//- Largest piece of a message: MPI counts with an int
const int64_t most = int64_t(1) << 30;

//- Time between two looks for a letter that may take long
const std::chrono::microseconds pause(100);

const Foam::UPstream::commsTypes now = Foam::UPstream::commsTypes::scheduled;

} // End anonymous namespace


Foam::rankPost::rankPost()
:
    speakers_(),
    clients_(),
    proxies_(),
    isFound_(true)
{}


Foam::rankPost::~rankPost()
{
    close();
}


void Foam::rankPost::find(const string& run)
{
    const label own = Pstream::myProcNo();
    labelList here(Pstream::nProcs(), 0);
    here[own] = label(amberfield_run_is_here(run.c_str()));
    Pstream::gatherList(here);
    Pstream::scatterList(here);

    DynamicList<label> near;
    forAll(here, rank)
    {
        if (here[rank])
        {
            near.append(rank);
        }
    }
    isFound_ = !near.empty();
    if (!isFound_)
    {
        // Whoever opens the run says why that is not possible
        return;
    }
    speakers_.resize(here.size());
    DynamicList<label> clients;
    label next = 0;
    forAll(here, rank)
    {
        speakers_[rank] = here[rank] ? rank : near[next++ % near.size()];
        if (!here[rank] && speakers_[rank] == own)
        {
            clients.append(rank);
        }
    }
    clients_ = clients;
    if (next > 0)
    {
        Info<< next << " of " << here.size()
            << " ranks are on other machines than the DEM process" << nl << endl;
    }
    else
    {
        speakers_.clear();
    }
}


bool Foam::rankPost::isHere() const
{
    return !isNeeded() || speakers_[Pstream::myProcNo()] == Pstream::myProcNo();
}


bool Foam::rankPost::isNeeded() const
{
    return !speakers_.empty();
}


AmberfieldStatus Foam::rankPost::noted
(
    const AmberfieldStatus status,
    const AmberfieldProxy* proxy
)
{
    if (status == AmberfieldStatus_Failed)
    {
        reason_ = amberfield_proxy_error(proxy);
    }
    return status;
}


AmberfieldStatus Foam::rankPost::open(const string& run)
{
    proxies_.setSize(clients_.size(), nullptr);
    forAll(clients_, i)
    {
        proxies_[i] = amberfield_proxy_open
        (
            run.c_str(), uint32_t(clients_[i]), uint32_t(Pstream::nProcs())
        );
        reason_ = amberfield_proxy_error(proxies_[i]);
        if (!reason_.empty())
        {
            return AmberfieldStatus_Failed;
        }
    }
    return AmberfieldStatus_Ok;
}


void Foam::rankPost::send
(
    const label rank,
    const AmberfieldStatus status,
    const AmberfieldLetter& letter
)
{
    const heading first = {int64_t(status), int64_t(letter.count)};
    const char* start = reinterpret_cast<const char*>(&first);
    UOPstream::write(now, rank, start, sizeof(first), tag, UPstream::worldComm);
    start = reinterpret_cast<const char*>(letter.bytes);
    for (int64_t done = 0; done < first.count; done += most)
    {
        const int64_t piece = std::min(most, first.count - done);
        UOPstream::write(now, rank, start + done, piece, tag, UPstream::worldComm);
    }
}


Foam::rankPost::heading Foam::rankPost::receive(const label rank, const bool isLong)
{
    heading first = {0, 0};
    char* start = reinterpret_cast<char*>(&first);
    if (isLong)
    {
        // MPI's own wait would keep the processor busy while the grains move
        const label request = UPstream::nRequests();
        const auto later = UPstream::commsTypes::nonBlocking;
        UIPstream::read(later, rank, start, sizeof(first), tag, UPstream::worldComm);
        while (!UPstream::finishedRequest(request))
        {
            std::this_thread::sleep_for(pause);
        }
        UPstream::resetRequests(request);
    }
    else
    {
        UIPstream::read(now, rank, start, sizeof(first), tag, UPstream::worldComm);
    }
    letter_.resize(std::size_t(first.count));
    for (int64_t done = 0; done < first.count; done += most)
    {
        const int64_t piece = std::min(most, first.count - done);
        UIPstream::read(now, rank, letter_.data() + done, piece, tag, UPstream::worldComm);
    }
    return first;
}


AmberfieldStatus Foam::rankPost::wait(AmberfieldField* field, AmberfieldRequest& request)
{
    if (!isHere())
    {
        const heading came = receive(speakers_[Pstream::myProcNo()], true);
        if (came.status != AmberfieldStatus_Ok)
        {
            // A failure is the other rank's to tell
            return came.status == AmberfieldStatus_Over ? AmberfieldStatus_Over : AmberfieldStatus_Ok;
        }
        const uint8_t* bytes = reinterpret_cast<const uint8_t*>(letter_.data());
        const AmberfieldStatus status = amberfield_field_deliver(field, bytes, letter_.size());
        return status == AmberfieldStatus_Ok ? amberfield_field_wait(field, &request) : status;
    }

    AmberfieldStatus status = amberfield_field_wait(field, &request);
    forAll(clients_, i)
    {
        AmberfieldLetter letter = {nullptr, 0};
        if (status == AmberfieldStatus_Ok)
        {
            status = noted(amberfield_proxy_wait(proxies_[i], &letter), proxies_[i]);
        }
        send(clients_[i], status, letter);
    }
    return status;
}


AmberfieldStatus Foam::rankPost::carry(AmberfieldField* field)
{
    if (!isHere())
    {
        AmberfieldLetter letter = {nullptr, 0};
        const AmberfieldStatus status = amberfield_field_letter(field, &letter);
        send(speakers_[Pstream::myProcNo()], status, letter);
        return status;
    }

    AmberfieldStatus status = AmberfieldStatus_Ok;
    forAll(clients_, i)
    {
        const heading came = receive(clients_[i], false);
        if (status == AmberfieldStatus_Ok && came.status == AmberfieldStatus_Ok)
        {
            const uint8_t* bytes = reinterpret_cast<const uint8_t*>(letter_.data());
            status = noted(amberfield_proxy_send(proxies_[i], bytes, letter_.size()), proxies_[i]);
        }
    }
    return status;
}


void Foam::rankPost::close()
{
    for (AmberfieldProxy* proxy : proxies_)
    {
        amberfield_proxy_close(proxy);
    }
    proxies_.clear();
}
