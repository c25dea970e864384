//! Panics as errors: the crate `parquet` panics on some damaged files.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether a panic of this thread becomes an error, and is not printed.
    static IS_EXPECTED: Cell<bool> = const { Cell::new(false) };
}

/// The result of a read, where a panic counts as an error and is not printed.
///
/// The caller drops what was read in part, so the assertion of unwind safety holds.
///
/// # Errors
/// The reason in words.
pub fn caught<T>(reading: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_EXPECTED.get() {
                usual(panic);
            }
        }));
    });
    let before = IS_EXPECTED.replace(true);
    let read = catch_unwind(AssertUnwindSafe(reading));
    IS_EXPECTED.set(before);
    read.unwrap_or_else(|panic| Err(format!("it is damaged ({})", words(panic.as_ref()))))
}

/// Message of a panic.
fn words(panic: &(dyn Any + Send)) -> &str {
    let owned = panic.downcast_ref::<String>().map(String::as_str);
    owned
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("the reader stopped")
}
