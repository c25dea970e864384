//! From an estimate to a train: accept or refuse, then design.
