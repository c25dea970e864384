//! What runs at the tick.
