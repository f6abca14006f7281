//! Nothing is copied between the processes: both map the same memory, and an exchange allocates next to
//! nothing.

use amberfield_core::{Boundary, Domain, FarQuestion, SourceCloud, Vector3};
use amberfield_coupling::{Announced, BoxSolver, FieldSide, MeshArrays, Reply, SolverSettings};
use amberfield_field::far::{FarField, FarRequest, FarValues};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Bytes asked for so far.
static ALLOCATED: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: the system's allocator does it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATED.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Question whose answer does not matter here.
const QUESTION: FarQuestion = FarQuestion {
    cloud: SourceCloud { radius_m: 1e-3, shape: 10.0 },
    permittivity_f_m: 1.0,
    neutralising_background: 0,
    time_s: 0.0,
    tolerance: 0.0,
    wants_e: 1,
};
const CHARGES: usize = 500_000;
const EXCHANGES: usize = 5;

/// The mapping that holds an address: its file's name and number.
fn mapping_of(address: usize) -> (String, String) {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("the system shows mappings");
    let holds = |line: &&str| {
        let range = line.split([' ', '-']).take(2).map(|word| usize::from_str_radix(word, 16).unwrap_or(0));
        let ends: Vec<usize> = range.collect();
        (ends[0]..ends[1]).contains(&address)
    };
    let line = maps.lines().find(holds).expect("every address is mapped");
    let words: Vec<&str> = line.split_whitespace().collect();
    (words.get(5).unwrap_or(&"").to_string(), words[4].to_owned())
}

#[test]
fn payloads_lie_in_shared_memory_and_exchanges_allocate_nothing_of_their_size() {
    let faces = [[Boundary::Grounded; 2]; 3];
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(0.01), faces).expect("a good box");
    let timeout = Duration::from_secs(20);
    let settings = SolverSettings { timeout, wait: Some(timeout), ..SolverSettings::awaited("none") };
    let announced = Announced::new(settings).expect("shared memory");
    let run = announced.run().to_owned();
    let name = run.clone();
    let answering = domain.clone();
    let field = std::thread::spawn(move || {
        let solver = BoxSolver::new(&answering, [20, 20, 20]).expect("a good mesh");
        let mesh = solver.mesh();
        let mut side = FieldSide::open(&name, 0, 1).expect("the run is there");
        side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0).expect("a good mesh");
        let potential = vec![1.0; mesh.cell_count()];
        let e = vec![[0.0; 3]; mesh.cell_count()];
        let mut first = true;
        while side.wait().expect("the DEM side lives").is_some() {
            if std::mem::take(&mut first) {
                let boundary = side.boundary(mesh.boundary().len()).expect("one number a face");
                let (file, number) = mapping_of(boundary.as_ptr() as usize);
                assert!(file.contains(&name) && number != "0", "the payload lies in {file}");
            }
            let reply = Reply { potential: &potential, e: &e, iterations: 0, residual: 0.0, seconds: 0.0 };
            side.reply(&reply).expect("it lives");
        }
        assert!(!first);
    });
    let mut remote = announced.connect().expect("the field side comes");
    let positions: Vec<Vector3<f64>> =
        (0..CHARGES).map(|i| Vector3::repeat(1e-3 + 8e-3 * i as f64 / CHARGES as f64)).collect();
    let charges = vec![1e-12; CHARGES];
    let boundary = vec![0.0; remote.mesh().boundary().len()];
    let request = FarRequest {
        question: QUESTION,
        positions: &positions,
        charges: &charges,
        image_positions: &[],
        image_charges: &[],
        density: &[],
        boundary: &boundary,
        guess: &[],
    };
    let mut values = FarValues::default();
    for _ in 0..2 {
        remote.solve(&request, &mut values).expect("it answers");
    }
    let before = ALLOCATED.load(Ordering::Relaxed);
    for _ in 0..EXCHANGES {
        remote.solve(&request, &mut values).expect("it answers");
    }
    let each = (ALLOCATED.load(Ordering::Relaxed) - before) / EXCHANGES;
    // Out go 32 bytes a charge, back come 32 a cell. What is left, some 100 kB whatever the payload, is
    // iceoryx2's waiting for events.
    let carried = 32 * (CHARGES + values.potential.len());
    assert!(50 * each < carried, "an exchange of {carried} bytes allocated {each}");
    drop(remote);
    field.join().expect("the field side ends well");
}
