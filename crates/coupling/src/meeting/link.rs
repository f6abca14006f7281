//! One side's end of the two channels between the processes: iceoryx2, and nothing of it beyond this file.
//!
//! A publish-subscribe service and an event service for either direction. Messages are written in place in
//! shared memory and read in place; events wake the receiver, who looks first and then waits in short slices,
//! so that a peer that dies is noticed.

use super::run_root::{RunRoot, check_room, no_room};
use crate::CouplingError;
use amberfield_wire::{Block64, Header, Layout, Letter, MessageKind, Section, Sections, WireError};
use iceoryx2::node::NodeView as _;
use iceoryx2::port::listener::{Listener, ListenerWaitError};
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe::PortFactory as Channel;
use std::mem::MaybeUninit;
use std::time::{Duration, Instant};

type Ipc = ipc_threadsafe::Service;
type Sample = iceoryx2::sample::Sample<Ipc, [Block64], Header>;
type Outbox = Publisher<Ipc, [Block64], Header>;

/// Time that a receiver waits before it looks whether its peer lives.
const SLICE: Duration = Duration::from_millis(20);
/// Time between two looks for services that are not there yet.
const POLL: Duration = Duration::from_millis(5);
/// Room for more than the first message needs, so that a few more grains do not need new memory.
const HEADROOM: f64 = 1.25;
/// Room for what iceoryx2 keeps beside the messages, and more [bytes].
const BOOKKEEPING: usize = 1 << 20;
/// Name of the DEM process's node.
pub(super) const DEM: &str = "dem";

/// Side of the coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SideOf {
    Dem,
    Field { rank: u32 },
}

impl SideOf {
    /// Name of the other side in messages to the user.
    pub(crate) fn peer(self) -> &'static str {
        match self {
            Self::Dem => "field solver",
            Self::Field { .. } => "DEM process",
        }
    }

    fn node_name(self) -> String {
        match self {
            Self::Dem => DEM.to_owned(),
            Self::Field { rank } => format!("field-{rank}"),
        }
    }
}

/// A message received: in place in the run's memory, or as a letter.
#[derive(Debug)]
pub(crate) enum Message {
    Here(Sample),
    Letter(Letter),
}

impl Message {
    pub(crate) fn header(&self) -> &Header {
        match self {
            Self::Here(sample) => sample.user_header(),
            Self::Letter(letter) => letter.header(),
        }
    }

    pub(crate) fn sections(&self) -> Sections<'_> {
        match self {
            Self::Here(sample) => Sections::new(sample.user_header(), sample.payload()),
            Self::Letter(letter) => letter.sections(),
        }
    }

    /// A copy of it that can travel.
    pub(crate) fn to_letter(&self) -> Letter {
        match self {
            Self::Here(sample) => Letter::new(sample.user_header(), sample.payload()),
            Self::Letter(letter) => letter.clone(),
        }
    }

    /// The message, if it is of the run and not the last: the last one is an error with its reason.
    pub(super) fn unless_last(self, peer: &'static str, run: u64) -> Result<Self, CouplingError> {
        let kind = self.header().check(run);
        let reason = || self.sections().text();
        match kind.map_err(|error| CouplingError::Wire { peer, error })? {
            MessageKind::End => Err(CouplingError::Ended { peer, reason: reason() }),
            MessageKind::Refusal => Err(CouplingError::Refused(reason())),
            _ => Ok(self),
        }
    }
}

/// End of the two channels on one side.
#[derive(Debug)]
pub(crate) struct Link {
    side: SideOf,
    run: u64,
    config: Config,
    channel: Channel<Ipc, [Block64], Header>,
    /// Publisher, and the largest number of blocks that it can send.
    publisher: Option<(Outbox, usize)>,
    notifier: Notifier<Ipc>,
    subscriber: Subscriber<Ipc, [Block64], Header>,
    listener: Listener<Ipc>,
    _node: Node<Ipc>,
}

impl Link {
    /// Creates (DEM side) or opens (field side, until the deadline) the channels of a run with so many field
    /// processes.
    pub(crate) fn new(
        root: &RunRoot,
        side: SideOf,
        ranks: u32,
        deadline: Instant,
    ) -> Result<Self, CouplingError> {
        set_log_level(LogLevel::Fatal);
        check_room(BOOKKEEPING)?;
        let config = config_of(root)?;
        let node = NodeBuilder::new()
            .config(&config)
            .name(&said(NodeName::new(&side.node_name()))?)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>();
        let node = said(node)?;
        root.close()?;
        let [to_field, to_dem] = ["charges", "fields"];
        let (outgoing, incoming) = if side == SideOf::Dem { (to_field, to_dem) } else { (to_dem, to_field) };
        let ranks = ranks as usize;
        let channel = |name: &str| {
            let name = said(ServiceName::new(name))?;
            let builder = || {
                node.service_builder(&name)
                    .publish_subscribe::<[Block64]>()
                    .user_header::<Header>()
                    .history_size(0)
                    .subscriber_max_buffer_size(2)
                    .subscriber_max_borrowed_samples(2)
                    .enable_safe_overflow(false)
                    .max_publishers(2 * ranks)
                    .max_subscribers(ranks)
                    .max_nodes(2 * ranks + 2)
            };
            match side {
                SideOf::Dem => said(builder().create()),
                SideOf::Field { .. } => until(deadline, || builder().open()),
            }
        };
        let event = |name: &str| {
            let name = said(ServiceName::new(&format!("{name} sent")))?;
            let builder = || {
                node.service_builder(&name)
                    .event()
                    .max_notifiers(ranks)
                    .max_listeners(ranks)
                    .max_nodes(2 * ranks + 2)
            };
            match side {
                SideOf::Dem => said(builder().create()),
                SideOf::Field { .. } => until(deadline, || builder().open()),
            }
        };
        Ok(Self {
            side,
            run: root.run(),
            channel: channel(outgoing)?,
            publisher: None,
            notifier: said(event(outgoing)?.notifier_builder().create())?,
            subscriber: said(channel(incoming)?.subscriber_builder().create())?,
            listener: said(event(incoming)?.listener_builder().create())?,
            config,
            _node: node,
        })
    }

    /// The run's number.
    pub(crate) fn run(&self) -> u64 {
        self.run
    }

    /// Sends a message to so many receivers: `write` fills its sections in place.
    pub(crate) fn send(
        &mut self,
        layout: &Layout,
        receivers: usize,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        self.publish(layout.header(), layout.blocks(), receivers, write)
    }

    /// Sends a message that came as a letter to one receiver.
    pub(crate) fn send_letter(&mut self, letter: &Letter) -> Result<(), CouplingError> {
        let payload = letter.payload();
        self.publish(letter.header(), payload.len(), 1, |blocks| {
            blocks.write_copy_of_slice(payload);
            Ok(())
        })
    }

    fn publish(
        &mut self,
        header: &Header,
        blocks: usize,
        receivers: usize,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        if self.publisher.as_ref().is_none_or(|(_, most)| *most < blocks) {
            self.publisher = None;
            let most = (HEADROOM * blocks as f64).ceil() as usize;
            self.publisher = Some((self.new_publisher(most)?, most));
        }
        let (publisher, _) = self.publisher.as_ref().expect("just made");
        let mut sample = said(publisher.loan_slice_uninit(blocks))?;
        populate(sample.payload_mut())?;
        *sample.user_header_mut() = *header;
        write(sample.payload_mut()).map_err(|error| CouplingError::Wire { peer: "own side", error })?;
        // SAFETY: every section was written by `write`, or set to zero when it was asked for; what no section
        // covers is memory that `populate` has made, where any bit pattern is a block.
        let sample = unsafe { sample.assume_init() };
        let reached = said(sample.send())?;
        if reached != receivers {
            return Err(CouplingError::Lost {
                peer: self.side.peer(),
                how: format!("a message reached {reached} of {receivers}"),
                solve: header.solve,
            });
        }
        said(self.notifier.notify())?;
        Ok(())
    }

    /// Says that this was the last message, and why; the header's kind is an end or a refusal.
    pub(crate) fn end(&mut self, header: Header, receivers: usize, why: &str) -> Result<(), CouplingError> {
        let layout = Layout::new(header).with::<u8>(Section::Text, why.len());
        self.send(&layout, receivers, |payload| {
            layout.section_mut::<u8>(payload, Section::Text)?.copy_from_slice(why.as_bytes());
            Ok(())
        })
    }

    fn new_publisher(&self, blocks: usize) -> Result<Outbox, CouplingError> {
        check_room(BOOKKEEPING + blocks * size_of::<Block64>())?;
        said(
            self.channel
                .publisher_builder()
                .initial_max_slice_len(blocks)
                .allocation_strategy(AllocationStrategy::Static)
                .backpressure_strategy(BackpressureStrategy::DiscardData)
                .max_loaned_samples(1)
                .create(),
        )
    }

    /// The next message, once it is there; `alive` is asked now and then whether it is worth waiting.
    pub(crate) fn receive(
        &self,
        solve: u64,
        timeout: Duration,
        mut alive: impl FnMut() -> Result<(), String>,
    ) -> Result<Message, CouplingError> {
        let start = Instant::now();
        let peer = self.side.peer();
        loop {
            if let Some(sample) = said(self.subscriber.receive())? {
                return Message::Here(sample).unless_last(peer, self.run);
            }
            let waited = start.elapsed();
            if waited >= timeout {
                return Err(CouplingError::TimedOut { peer, solve, waited });
            }
            match self.listener.timed_wait(|_| {}, SLICE.min(timeout - waited)) {
                // A run that is asked to stop does so after this step, which needs its answer.
                Ok(_) | Err(ListenerWaitError::InterruptSignal) => {}
                Err(error) => return said(Err(error)),
            }
            if let Err(how) = alive() {
                // It may have answered with its last breath.
                if said(self.subscriber.has_samples())? {
                    continue;
                }
                return Err(CouplingError::Lost { peer, how, solve });
            }
        }
    }

    /// Whether the DEM process lives, for the field side.
    pub(crate) fn dem_is_alive(&self) -> Result<(), String> {
        if is_alive(&self.config, DEM) { Ok(()) } else { Err("it no longer runs".into()) }
    }
}

/// Whether a node of this name lives.
pub(super) fn is_alive(config: &Config, name: &str) -> bool {
    let mut alive = false;
    let listed = Node::<Ipc>::list(config, |state| {
        if let NodeState::Alive(view) = state
            && view.details().as_ref().is_some_and(|details| details.name().as_str() == name)
        {
            alive = true;
            return CallbackProgression::Stop;
        }
        CallbackProgression::Continue
    });
    listed.is_ok() && alive
}

/// The configuration of iceoryx2 for a run.
pub(super) fn config_of(root: &RunRoot) -> Result<Config, CouplingError> {
    let mut config = Config::default();
    let path = root.path();
    config.global.set_root_path(&said(iceoryx2::prelude::Path::new(path.as_os_str().as_encoded_bytes()))?);
    config.global.prefix = said(FileName::new(root.prefix().as_bytes()))?;
    config.global.node.cleanup_dead_nodes_on_creation = false;
    config.global.node.cleanup_dead_nodes_on_destruction = false;
    Ok(config)
}

/// Touches every page of fresh memory, so that a full /dev/shm is an error now and no signal later.
fn populate(payload: &mut [MaybeUninit<Block64>]) -> Result<(), CouplingError> {
    const PAGE: usize = 4096;
    let bytes = size_of_val(payload);
    let start = payload.as_mut_ptr().cast::<u8>();
    let before = start as usize % PAGE;
    // SAFETY: the pages belong to the segment that holds the payload; populating changes no byte of them.
    let populated = unsafe {
        rustix::mm::madvise(start.sub(before).cast(), before + bytes, rustix::mm::Advice::LinuxPopulateWrite)
    };
    populated.map_err(|error| no_room(bytes, &error))
}

/// Tries again until the deadline: the other side may not be there yet.
fn until<T, E: std::fmt::Debug>(
    deadline: Instant,
    attempt: impl Fn() -> Result<T, E>,
) -> Result<T, CouplingError> {
    loop {
        match attempt() {
            Err(_) if Instant::now() < deadline => std::thread::sleep(POLL),
            result => return said(result),
        }
    }
}

/// Errors of iceoryx2 in its own words.
fn said<T, E: std::fmt::Debug>(result: Result<T, E>) -> Result<T, CouplingError> {
    result.map_err(|error| CouplingError::SharedMemory(format!("{error:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_wire::PROTOCOL_VERSION;

    #[test]
    fn a_message_of_another_version_is_refused() {
        let root = RunRoot::create().unwrap();
        let deadline = Instant::now() + Duration::from_secs(1);
        let link = |side| Link::new(&root, side, 1, deadline).unwrap();
        let (dem, mut field) = (link(SideOf::Dem), link(SideOf::Field { rank: 0 }));
        let version = PROTOCOL_VERSION + 1;
        let header = Header { version, ..Header::new(MessageKind::Mesh, root.run(), 0) };
        field.send(&Layout::new(header), 1, |_| Ok(())).unwrap();
        let refused = dem.receive(0, Duration::from_secs(1), || Ok(())).unwrap_err();
        let expected = WireError::Version { theirs: version, ours: PROTOCOL_VERSION };
        assert!(
            matches!(&refused, CouplingError::Wire { error, .. } if *error == expected),
            "the version in {refused}"
        );
    }
}
