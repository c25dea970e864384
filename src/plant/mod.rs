//! The axis as a chain: servo, transmission, link, sensors.
