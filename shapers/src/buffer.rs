//! Where a filter keeps what it remembers.

use core::ops::DerefMut;

/// A slice that a filter owns (`Box<[T]>`) or has been lent (`&mut [T]`).
pub trait Buffer<T>: DerefMut<Target = [T]> {}

impl<T, B: DerefMut<Target = [T]>> Buffer<T> for B {}

/// What filters take if nothing else is said: a buffer on the heap, or where there is none (without the
/// feature `alloc`) one that is lent for good.
#[cfg(feature = "alloc")]
pub type OwnBuffer<T> = alloc::boxed::Box<[T]>;
/// What filters take if nothing else is said: there is no heap, so a buffer that is lent for good.
#[cfg(not(feature = "alloc"))]
pub type OwnBuffer<T> = &'static mut [T];

#[cfg(feature = "alloc")]
pub(crate) fn on_heap<T: Clone + Default>(length: usize) -> OwnBuffer<T> {
    alloc::vec![T::default(); length].into_boxed_slice()
}
