//! A steady evaluation allocates nothing: only the first ones make room.

use amberfield_core::{FieldSettings, Tuning};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::reference;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: hands every call on to the system's allocator and counts.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_steady_p3m_evaluation_allocates_nothing() {
    let settings = FieldSettings { tolerance: 1e-3, tuning: Tuning::Model, ..FieldSettings::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        for name in ["c_grounded_box_bip_2000", "d_grounded_z_periodic_xy_net_2000"] {
            let set = reference::by_name(name).unwrap();
            let mut field = ElectricField::new(&set.domain, &settings, &set.position, &set.charge).unwrap();
            let mut values = FieldValues::default();
            let wanted = Wanted { potential: true, components: true };
            for _ in 0..2 {
                field.evaluate(&set.position, &set.charge, wanted, &mut values).unwrap();
            }
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            field.evaluate(&set.position, &set.charge, wanted, &mut values).unwrap();
            assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - before, 0, "{name}");
        }
    });
}
