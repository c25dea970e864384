//! Requests to the system for the tick: real-time priority, and locked memory.

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};
use tracing::warn;

/// Priority among real-time threads, 1 to 99: above ordinary interrupt threads (50), below the
/// kernel's own watchdogs (99).
const PRIORITY: u8 = 80;

/// Gives the calling thread a real-time priority (SCHED_FIFO); returns whether it was allowed.
pub fn raise_priority() -> bool {
    let Ok(priority) = PRIORITY.try_into() else {
        return false;
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(priority);
    match set_thread_priority_and_policy(thread_native_id(), priority, policy) {
        Ok(()) => true,
        Err(error) => {
            warn!(
                "no real-time priority for the tick ({error}): it can come late when the machine is \
                 busy"
            );
            false
        }
    }
}

/// Prevents paging of the process' memory; returns whether it was allowed.
pub fn lock_memory() -> bool {
    // With a limit, later allocations would fail once it is reached: then only the present memory is locked.
    let flags = match getrlimit(Resource::Memlock).current {
        None => MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT,
        Some(_) => MlockAllFlags::CURRENT | MlockAllFlags::ONFAULT,
    };
    match mlockall(flags) {
        Ok(()) => true,
        Err(error) => {
            warn!("memory is not locked ({error}): a tick can wait for the disk");
            false
        }
    }
}
