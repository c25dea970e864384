//! Where a force is attached.

/// Where a force acts: between which of motor side, link and ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// Between motor side and ground.
    Motor,
    /// Between motor side and link.
    Across,
    /// Between link and ground.
    Link,
}

/// All attachments, in their order.
pub const ATTACHMENTS: [Attachment; 3] = [Attachment::Motor, Attachment::Across, Attachment::Link];
