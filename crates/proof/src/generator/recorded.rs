//! From motion to recording: stamps, quantised encoders, noise, lost samples.

use super::Channel as Kind;
use super::programme::Programme;
use super::random::Draw;
use super::refit::registered_rms;
use super::sensors::{Arm, Noise};
use quell_recording::{Channel, Recording, Role};

/// Sensors of an arm.
#[derive(Clone, Copy, Debug)]
pub struct Instruments {
    /// Rate of the motor side's encoder, Hz.
    pub encoder_rate: f64,
    /// Its resolution, rad or m.
    pub encoder_step: f64,
    /// Rate of the other sensor, Hz.
    pub sensor_rate: f64,
    /// Its noise.
    pub noise: Noise,
    /// Share of its samples that are lost.
    pub missing: f64,
    /// Scatter of its clock over its period; the stamps tell it.
    pub jitter: f64,
}

impl Instruments {
    /// Records an arm on its way through a programme.
    pub fn record(
        &self,
        draw: &mut Draw,
        arm: &Arm,
        programme: &Programme,
        (name, step): (&str, f64),
    ) -> Recording {
        let encoder = self.encoder(programme);
        let stamps = self.stamps(draw, arm, programme.duration);
        let mut columns = arm.read(programme, &stamps, step);
        columns
            .iter_mut()
            .for_each(|column| self.noise.add(draw, column));
        let (role, unit) = match arm.channel {
            Kind::Tip => (Role::TipPosition, "m"),
            Kind::Link => (Role::LinkPosition, "rad"),
            Kind::Deformation => (Role::Deformation, "rad"),
        };
        let sensor = Channel {
            role,
            unit: unit.into(),
            time: stamps,
            columns,
        };
        Recording {
            name: name.into(),
            payload: None,
            channels: vec![encoder, sensor],
        }
    }

    fn encoder(&self, programme: &Programme) -> Channel {
        let samples = (programme.duration * self.encoder_rate) as usize;
        let time: Vec<f64> = (0..samples).map(|k| k as f64 / self.encoder_rate).collect();
        let rounded = |&t: &f64| rounded(programme.at(t)[0], self.encoder_step);
        let column = time.iter().map(rounded).collect();
        Channel {
            role: Role::MotorPosition,
            unit: "rad".into(),
            time,
            columns: vec![column],
        }
    }

    /// Readings of the sensor's clock within the recording.
    fn stamps(&self, draw: &mut Draw, arm: &Arm, duration: f64) -> Vec<f64> {
        let period = 1.0 / self.sensor_rate;
        let phase = draw.uniform(0.0, period);
        let mut stamps = Vec::new();
        for k in 1.. {
            // Less than half a period on either side, so that they stay in order.
            let scatter = (self.jitter * draw.normal()).clamp(-0.45, 0.45);
            let lost = draw.chance(self.missing);
            let stamp = (k as f64 + scatter) * period + phase;
            let stamp = rounded(stamp, 1e-7);
            if arm.true_time(stamp) > duration - period {
                break;
            }
            if !lost && arm.true_time(stamp) > 0.0 {
                stamps.push(stamp);
            }
        }
        stamps
    }
}

/// The recording from a time on; its clocks run as before.
pub fn begun_later(mut recording: Recording, start: f64) -> Recording {
    for channel in &mut recording.channels {
        let early = channel.time.partition_point(|&time| time < start);
        channel.time.drain(..early);
        for column in &mut channel.columns {
            column.drain(..early);
        }
    }
    recording
}

/// To the nearest step.
pub fn rounded(value: f64, step: f64) -> f64 {
    step * (value / step).round()
}

/// The true arm on the test's moves.
#[derive(Clone, Debug)]
pub struct TrueTest {
    /// The arm.
    pub arm: Arm,
    /// Its motion.
    pub programme: Programme,
    /// One standard deviation of the noise.
    pub noise: f64,
    /// Step of the integration, s.
    pub step: f64,
}

/// Clock offsets on either side of the true one, s, through which a parabola is laid.
const ASIDE: f64 = 5e-5;

impl TrueTest {
    /// Rms over the noise when only the sensor's clock, zero and frame are fitted.
    pub fn rms_over_noise(&self, test: &Recording) -> f64 {
        let Some(sensor) = test.channels.get(1) else {
            return f64::NAN;
        };
        let rms = |shift: f64| {
            let mut arm = self.arm.clone();
            arm.clock_offset += shift;
            let seen = arm.read(&self.programme, &sensor.time, self.step);
            self.distance(&arm, &seen, sensor)
        };
        let [early, now, late] = [-ASIDE, 0.0, ASIDE].map(rms).map(|rms| rms * rms);
        // The lowest point of the parabola.
        let (slope, bend) = (late - early, late + early - 2.0 * now);
        let gain = if bend > 0.0 {
            slope * slope / (8.0 * bend)
        } else {
            0.0
        };
        (now - gain).max(0.0).sqrt() / self.noise
    }

    fn distance(&self, arm: &Arm, seen: &[Vec<f64>], sensor: &Channel) -> f64 {
        if arm.channel == Kind::Tip {
            // The frame is fitted between the two clouds of points themselves.
            return cloud_rms(seen, &sensor.columns) / 3f64.sqrt();
        }
        let left: Vec<f64> = seen[0]
            .iter()
            .zip(&sensor.columns[0])
            .map(|(a, b)| a - b)
            .collect();
        let count = left.len().max(1) as f64;
        let mean = left.iter().sum::<f64>() / count;
        (left.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

fn cloud_rms(from: &[Vec<f64>], to: &[Vec<f64>]) -> f64 {
    let [x, y, z] = from else { return f64::NAN };
    let points = x
        .iter()
        .zip(y)
        .zip(z)
        .map(|((&x, &y), &z)| nalgebra::Vector3::new(x, y, z));
    registered_rms(&points.collect::<Vec<_>>(), to)
}
