//! Joint states without a header, as `ros2 topic echo --csv` writes them.

use super::super::dates::GIGA;
use super::super::stamp::is_since_1970;

/// The names of the columns of such a row: seconds, nanoseconds and frame, the names of `n` joints, then `n` positions, velocities
/// and efforts, as `sensor_msgs/JointState` has them. What a driver does not measure has no cells: so `n` numbers are positions,
/// and of `2 n` the others are not named.
pub fn names(row: &[String]) -> Option<Vec<String>> {
    let number = |cell: &String| cell.trim().parse::<f64>().ok();
    let [seconds, nanoseconds, _, rest @ ..] = row else {
        return None;
    };
    let is_stamp = number(seconds).is_some_and(is_since_1970)
        && number(nanoseconds).is_some_and(|own| (0.0..GIGA as f64).contains(&own));
    let is_name = |cell: &&String| !cell.trim().is_empty() && number(cell).is_none();
    let joints: Vec<&String> = rest.iter().take_while(is_name).collect();
    let values = &rest[joints.len()..];
    let whole = values.len().checked_div(joints.len())?;
    let is_whole = (1..=3).contains(&whole) && values.len() == whole * joints.len();
    if !(is_stamp && is_whole && values.iter().all(|cell| number(cell).is_some())) {
        return None;
    }
    let quantities = match whole {
        3 => &["position [rad]", "velocity [rad/s]", "effort [N.m]"][..],
        _ => &["position [rad]"][..],
    };
    let mut names: Vec<String> = (1..=row.len()).map(|column| column.to_string()).collect();
    let cells = names[3 + joints.len()..].iter_mut();
    let said = quantities.iter().flat_map(|quantity| {
        joints
            .iter()
            .map(move |joint| format!("{joint} {quantity}"))
    });
    for (name, said) in cells.zip(said) {
        *name = said;
    }
    Some(names)
}
