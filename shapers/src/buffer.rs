//! Where a filter keeps what it remembers.

use core::ops::DerefMut;

/// A slice that a filter owns (`Box<[T]>`) or has been lent (`&mut [T]`).
pub trait Buffer<T>: DerefMut<Target = [T]> {}

impl<T, B: DerefMut<Target = [T]>> Buffer<T> for B {}

/// The default buffer of filters: one on the heap, or where there is none (without the
/// feature `alloc`) one that is lent for good.
#[cfg(feature = "alloc")]
pub type OwnBuffer<T> = alloc::boxed::Box<[T]>;
/// The default buffer of filters: there is no heap, so one that is lent for good.
#[cfg(not(feature = "alloc"))]
pub type OwnBuffer<T> = &'static mut [T];

#[cfg(feature = "alloc")]
pub(crate) fn on_heap<T: Clone + Default>(length: usize) -> OwnBuffer<T> {
    alloc::vec![T::default(); length].into_boxed_slice()
}
