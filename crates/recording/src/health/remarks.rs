//! Remarks on problems of a channel.

use super::{Clipped, Clock, ColumnHealth, Flat, FlatKind, Health, clipped};
use crate::{Channel, Unit, axis_name, plain};

/// Jitter, as a share of the period, above which there is a remark. A stamp that is off by j shifts a sample by
/// j times the slope; 1 % of a period is 1 % of an increment between samples.
pub const JITTER: f64 = 0.01;
/// Quantisation step, as a share of the range, above which there is a remark: the rounding error,
/// `step / sqrt(12)`, is then above 0.3 % of the range.
const COARSE: f64 = 0.01;

/// Period, s, above which there is a remark. Joints of robots vibrate at 1 Hz and above (those recorded in this
/// project at 1.8 Hz and above), which two samples a second or fewer cannot show. A clock in milliseconds that
/// is read as seconds has a thousand times its true period.
const SLOW: f64 = 0.5;

/// One sentence for each problem; empty without any.
pub fn remarks(channel: &Channel, health: &Health) -> Vec<String> {
    let mut remarks = Vec::new();
    if !channel.has_usual_unit() {
        let (unit, role) = (&channel.unit, channel.role);
        remarks.push(match unit.as_str() {
            "raw" | "count" | "count/s" => format!(
                "it has no physical unit: amplitudes are told in {unit}; frequencies and damping ratios need none"
            ),
            _ => format!("the unit {unit} is not one of {role}: kept as it is"),
        });
    }
    clock(&health.clock, &mut remarks);
    for (index, column) in health.columns.iter().enumerate() {
        let name = match health.columns.len() {
            1 => String::new(),
            count => format!("{}: ", axis_name(count, index).unwrap_or("?")),
        };
        remarks.extend(
            self::values(channel, (column, &channel.columns[index]))
                .into_iter()
                .map(|remark| name.clone() + &remark),
        );
    }
    remarks
}

/// A sentence, without a full stop, on stamps whose usual distance is not that of as many samples a second, or that are rounded by more
/// than [`JITTER`] allows.
pub fn mixed_rates(clock: &Clock) -> Option<String> {
    if let Some(rounded) = clock.rounded {
        let step = plain(rounded.step);
        let Some(rates) = rounded.rates else {
            let mean = rounded.mean;
            return Some(format!(
                "its stamps are rounded to {step} s, and drift by more than that from an even clock: {mean:.2} samples a second on the whole"
            ));
        };
        let [least, greatest] = rates.map(|rate| format!("{rate:.2}"));
        let told = match least == greatest {
            true => format!("{least} samples a second"),
            false => format!("{least} to {greatest} samples a second"),
        };
        return is_jittery(clock)
            .then(|| format!("its stamps are rounded to {step} s: together they tell {told}"));
    }
    let (usual, mean) = clock.usual_rate().zip(clock.mean_rate())?;
    let differ = (mean / usual - 1.0).abs() > JITTER && !matches!(clock.gaps[..], [_]);
    differ.then(|| {
        format!("its stamps are mostly {usual:.2} Hz apart, but it has {mean:.2} samples a second")
    })
}

fn is_jittery(clock: &Clock) -> bool {
    clock.jitter > JITTER * clock.period
}

fn clock(clock: &Clock, remarks: &mut Vec<String>) {
    if clock.samples == 1 {
        remarks.push("it has one sample only".into());
    }
    if clock.period >= SLOW {
        remarks.push(format!(
            "a sample every {:.3} s shows no vibration of a robot: its time may not be in seconds",
            clock.period
        ));
    }
    if let [first, ..] = clock.gaps[..] {
        remarks.push(format!(
            "{} missing samples in {} gap(s), the first from {} to {} s",
            clock.missing,
            clock.gaps.len(),
            plain(first.from),
            plain(first.until)
        ));
    }
    remarks.extend(mixed_rates(clock));
    if is_jittery(clock) && clock.rounded.is_none() {
        remarks.push(format!(
            "the clock jitters by {:.1} % of its period (root mean square; worst {:.1} %)",
            100.0 * clock.jitter / clock.period,
            100.0 * clock.worst_jitter / clock.period
        ));
    }
}

fn values(channel: &Channel, (column, values): (&ColumnHealth, &[f64])) -> Vec<String> {
    let unit = &channel.unit;
    let mut remarks = Vec::new();
    if column.minimum == column.maximum && channel.time.len() > 1 {
        remarks.push(format!(
            "the value is {} {unit} throughout",
            plain(column.minimum)
        ));
    }
    let may_clip = channel.role.is_acceleration();
    match may_clip.then(|| clipped(values)).flatten() {
        Some(clipped) => remarks.push(at_limit(&clipped, unit)),
        None => flats(channel, column, &mut remarks),
    }
    if let [first, ..] = column.wraps[..] {
        let count = column.wraps.len();
        remarks.push(format!(
            "jumps by a turn {count} time(s), first at {} s: the jumps are taken out where the angle is used",
            plain(first)
        ));
    }
    if let [first, ..] = column.spikes[..] {
        let count = column.spikes.len();
        remarks.push(format!(
            "{count} lone sample(s) far from both neighbours, first at {} s",
            plain(first)
        ));
    }
    let range = column.maximum - column.minimum;
    if let Some(step) = column.quantum.filter(|step| *step > COARSE * range) {
        let share = 100.0 * step / range;
        remarks.push(format!(
            "coarse: one quantisation step is {share:.1} % of the range"
        ));
    }
    remarks
}

/// A value without what the conversion of its unit left behind the digits that anybody reads.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A clause on a clipped sensor: its limit, and how many samples are at it.
pub fn at_limit(clipped: &Clipped, unit: &str) -> String {
    let limit = six_digits(clipped.limit);
    let gravity = Unit::from_name("g").filter(|g| g.si == unit);
    let gravities = gravity.map(|g| format!(" ({:.2} g)", clipped.limit / g.to_si(1.0)));
    format!(
        "the sensor is clipped at {} {unit}{} in {} samples",
        plain(limit),
        gravities.unwrap_or_default(),
        clipped.samples.len()
    )
}

fn flats(channel: &Channel, column: &ColumnHealth, remarks: &mut Vec<String>) {
    let unit = &channel.unit;
    let words = [
        (
            FlatKind::Saturated,
            "stays at the end of its range, as if saturated,",
        ),
        (FlatKind::Stuck, "hangs at one value in motion"),
    ];
    // A command is piecewise constant by intention. So may a force be, up to the limit of its drive.
    let role = channel.role;
    let is_told =
        |kind: FlatKind| role.is_motion() || !role.is_input() && kind == FlatKind::Saturated;
    for (kind, words) in words.iter().filter(|(kind, _)| is_told(*kind)) {
        let of_kind = |flat: &&Flat| flat.kind == *kind;
        let count = column.flats.iter().filter(of_kind).count();
        if let Some(flat) = column
            .flats
            .iter()
            .filter(of_kind)
            .max_by_key(|flat| flat.samples)
        {
            remarks.push(format!(
                "{words} {count} time(s), longest {} samples from {} to {} s at {} {unit}",
                flat.samples,
                plain(flat.from),
                plain(flat.until),
                plain(six_digits(flat.value))
            ));
        }
    }
}
