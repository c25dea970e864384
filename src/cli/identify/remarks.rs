//! Remarks on modes without a known input: facts that the table does not show.

use super::alone::Alone;
use super::words;
use crate::identification::images;
use crate::identification::output_only::{Excitation, FoundMode, LeftOut, Reason};

impl Alone {
    /// Remarks on facts that the table does not show.
    pub fn remarks(&self) -> Vec<String> {
        let found = &self.found;
        let [from, until] = found.stretches[0];
        let more = match found.stretches.len() {
            1 => String::new(),
            n => format!(" and in {} more like it", n - 1),
        };
        let role = self.vibration.role;
        let percent = 100.0 * found.explained;
        let mut remarks = vec![match found.excitation {
            Excitation::Decay => format!(
                "{role} decays freely from {from:.3} s to {until:.3} s{more}; the modes are {percent:.1} % of its variance there."
            ),
            Excitation::Sweep { from, to } => format!(
                "{role} was excited by a sweep from {from:.1} to {to:.1} Hz. The modes explain {percent:.1} % of the \
                 variation of its spectrum."
            ),
            Excitation::Work => format!(
                "{role} vibrates throughout, as on a machine at work. The excitation is assumed to be broadband. The modes \
                 explain {percent:.1} % of the variation of its spectrum."
            ),
        }];
        if self.vibration.used < 1.0 {
            remarks.push(format!(
                "Only the longest stretch without a hole is used, {:.0} % of the samples.",
                100.0 * self.vibration.used
            ));
        }
        remarks.extend(
            self.mixed_rates
                .iter()
                .map(|remark| format!("{role}: {remark}.")),
        );
        remarks.extend(self.clipped.iter().map(|clause| match found.excitation {
            Excitation::Decay => {
                format!("{role}: {clause}. A decay is fitted from the last of them on.")
            }
            _ => format!(
                "{role}: {clause}. Clipping makes multiples of a mode's frequency: record again with a wider range."
            ),
        }));
        remarks.extend(found.left_out.iter().map(left_out));
        remarks.extend(found.modes.iter().filter_map(dependence));
        remarks.extend(self.images());
        remarks.extend(self.axes());
        let slowest = found.modes.first().map(|mode| mode.known.mode.hertz());
        remarks.extend(slowest.and_then(words::slow));
        remarks
    }
}

impl Alone {
    /// A sentence on the modes that may be images of faster ones: at `fs` samples a second `f` and any `k fs +- f` look the same, at
    /// even stamps. Below a fifth of the rate the nearest image is two octaves above, or more.
    ///
    /// Source: C. E. Shannon, Communication in the presence of noise, Proc. IRE 37 (1949). The bandwidth of a usual
    /// accelerometer is half its rate (data sheet of the ADXL345), with a filter that does not end there.
    fn images(&self) -> Option<String> {
        let rate = self.vibration.rate;
        let hertz = self
            .shaped_for()
            .into_iter()
            .map(|known| known.mode.hertz());
        let fast = hertz.filter(|hertz| *hertz > 0.2 * rate);
        let one = |hertz: f64| {
            let [first, second, third] = images(hertz, rate);
            format!(
                "{hertz:.2} Hz may be {first:.2} Hz, or {second:.2} or {third:.2} Hz and further ones"
            )
        };
        let all: Vec<String> = fast.map(one).collect();
        (!all.is_empty()).then(|| {
            format!(
                "At {rate:.0} samples a second a mode above {:.0} Hz looks like one below, where the sensor has no filter against it: \
                 {}. Record once more at another rate: a mode stays, an image moves.",
                0.5 * rate,
                all.join("; ")
            )
        })
    }

    /// A sentence on the axes of the modes, where they differ.
    fn axes(&self) -> Option<String> {
        let hertz = self
            .shaped_for()
            .into_iter()
            .map(|known| known.mode.hertz());
        let of: Vec<(&str, f64)> = hertz.filter_map(|f| Some((self.axis(f)?, f))).collect();
        if of.iter().all(|own| own.0 == of[0].0) {
            return None;
        }
        let one = |(axis, hertz): &(&str, f64)| format!("{hertz:.3} Hz along {axis}");
        let all: Vec<String> = of.iter().map(one).collect();
        Some(format!(
            "Strongest: {}. The model has the modes of all axes; where an axis of the machine excites only one of them, \
             shape that axis with --mode F,XI in the place of --model.",
            all.join(", ")
        ))
    }
}

/// A sentence on a mode whose frequency depends on the amplitude.
fn dependence(mode: &FoundMode) -> Option<String> {
    let shift = mode.frequency_shift;
    // Two standard deviations: 5 % by chance.
    if shift == 0.0 || shift.abs() < 2.0 * mode.frequency_shift_std {
        return None;
    }
    let hertz = mode.known.mode.hertz();
    let ratio = mode.known.mode.damping_ratio();
    let [first, last] = [hertz * (1.0 + shift), hertz].map(|own| format!("{own:.3}"));
    let damping = format!(
        "the damping ratio goes from {:.4} to {ratio:.4}",
        ratio + mode.damping_shift
    );
    Some(match first == last {
        true => format!(
            "The damping depends on the amplitude, the frequency hardly: from the start of the decay to its end {damping}. It is one mode."
        ),
        false => format!(
            "The frequency depends on the amplitude: {first} Hz at the start of the decay and {last} Hz at its end; {damping}. \
             It is one mode."
        ),
    })
}

/// A sentence on what was fitted and is no mode of its own.
fn left_out(one: &LeftOut) -> String {
    let (hertz, percent) = (one.hertz, 100.0 * one.share);
    let what = format!("Left out: {hertz:.3} Hz with {percent:.1} % of the amplitude");
    match one.reason {
        Reason::Distortion { order, of } => format!(
            "{what}. Its frequency and phase are {order} times those of {of:.3} Hz, and it decays as fast or faster: a nonlinear sensor or spring \
             makes it from that mode."
        ),
        Reason::Beside { of } => format!(
            "{what}. It lies within the width of the mode of {of:.3} Hz. That mode may not decay exponentially, which looks the same."
        ),
        Reason::Undamped => format!(
            "{what}. Its damping cannot be told from zero, as with the hum of a motor or of the mains: it is no free decay."
        ),
    }
}
