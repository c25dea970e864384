//! Properties of an effect, besides its law, that the rest of the program needs.

use super::{Effect, Law, Likeness, Parameter, ParameterRole, Place, Scales, Slot};

/// A simpler effect, and the values of its parameters.
pub type Part = (&'static Effect, Vec<f64>);

/// A property of an effect that affects its search or its report.
#[derive(Clone, Copy)]
pub enum Property {
    /// Its law contains that of a simpler effect as a limit: if either fits, the simpler one is reported.
    Contains(&'static Effect),
    /// As [`Property::Contains`], at values within its ranges instead of at their ends.
    Includes(&'static Effect),
    /// It acts as this simpler effect if its own frequency is far above the motion; its other parameters are
    /// then not determined.
    Becomes(&'static Effect),
    /// It acts as two simpler effects together; the function gives these for its values.
    Parts(fn(&[f64]) -> [Part; 2]),
    /// Motions of this sort do not distinguish it from the others of the same likeness.
    Alike(Likeness),
    /// A file may omit this parameter, which then has its neutral value.
    Optional(&'static str),
    /// The law may be without these parameters, which a file may omit. At their neutral values, below their ranges, the law is a
    /// simpler one; where one of them is at the low end of its range, it is as good as that.
    Vanish(&'static [&'static str]),
    /// It may act again: an event at another [time](ParameterRole::Time), what lasts in another recording.
    Recurs,
    /// Its misfit has many minima over its size: the frequency depends on the size and both must be right
    /// together, or the law acts at times that come and go with the size. The sizes of its starts are above 0, the one that
    /// acts least first.
    ManyMinima,
    /// It is a damper between link and ground, with the coefficient as its size. In free vibration it is
    /// equivalent to damping across the joint.
    DampsToGround,
    /// Only a sensor of the deformation, such as a strain gauge, can have it; a sensor of positions in space
    /// cannot.
    OfDeformationOnly,
    /// It is a constant shift of the stamps, equivalent to an offset of the sensor's own clock.
    ShiftsStamps,
    /// It is a static law: a curve over the coordinate of this slot.
    Slot(Slot),
    /// The same learned law with finer knots, for shapes that its own knots do not resolve.
    Finer(&'static Effect),
    /// It is a wrong scale: a tracker with it shows the same angles about the joint, and another radius.
    WrongScale,
}

impl Effect {
    fn is(&self, what: impl Fn(&Property) -> bool) -> bool {
        self.properties.iter().any(what)
    }

    /// Whether the law contains that of another effect as a limit.
    ///
    /// # Example
    /// ```
    /// use quell_model::effects::Effect;
    /// let [stribeck, coulomb] =
    ///     ["stribeck_friction", "coulomb_friction"].map(|name| Effect::from_name(name).unwrap());
    /// assert!(stribeck.contains(coulomb) && !coulomb.contains(stribeck));
    /// ```
    pub fn contains(&self, simpler: &Self) -> bool {
        self.limits().any(|limit| limit == simpler)
    }

    /// The simpler effects that the law contains as limits.
    pub fn limits(&self) -> impl Iterator<Item = &'static Self> {
        self.properties.iter().filter_map(|own| match own {
            Property::Contains(simpler) | Property::Includes(simpler) => Some(*simpler),
            _ => None,
        })
    }

    /// Whether its law is that of a simpler effect at the end of a range.
    pub fn has_limit_at_end(&self) -> bool {
        self.is(|own| matches!(own, Property::Contains(_)))
    }

    /// Whether the law may act as that of another effect in the whole recording.
    pub fn becomes(&self, simpler: &Self) -> bool {
        self.far_limits().any(|limit| limit == simpler)
    }

    /// The simpler effects as which the law acts if its own frequency is far above the motion.
    pub fn far_limits(&self) -> impl Iterator<Item = &'static Self> {
        self.properties.iter().filter_map(|own| match own {
            Property::Becomes(simpler) => Some(*simpler),
            _ => None,
        })
    }

    /// The two simpler effects that the law is equivalent to for these values, with their values.
    ///
    /// # Example
    /// ```
    /// use quell_model::effects::Effect;
    /// let effect = Effect::from_name("asymmetric_friction").unwrap();
    /// let [dry, constant] = effect.parts(&[20.0, 0.1]).unwrap();
    /// assert_eq!((dry.0.name, constant.0.name), ("coulomb_friction", "force_offset"));
    /// assert_eq!((dry.1, constant.1), (vec![20.0], vec![2.0]));
    /// ```
    pub fn parts(&self, values: &[f64]) -> Option<[Part; 2]> {
        self.properties.iter().find_map(|own| match own {
            Property::Parts(parts) => Some(parts(values)),
            _ => None,
        })
    }

    /// Whether it has a likeness.
    pub fn is_alike(&self, likeness: Likeness) -> bool {
        self.is(|own| matches!(own, Property::Alike(other) if *other == likeness))
    }

    /// Whether a file may omit a parameter.
    pub fn is_optional(&self, parameter: &Parameter) -> bool {
        self.is(|own| match own {
            Property::Optional(name) => *name == parameter.name,
            Property::Vanish(names) => names.contains(&parameter.name),
            _ => false,
        })
    }

    /// Whether its law is without the parameter of an index, which has this value.
    pub fn is_without(&self, index: usize, value: f64) -> bool {
        value == self.parameters[index].neutral && self.may_be_without(index)
    }

    /// Values of the simpler law without the parameters that it may be without; `None` where it is that.
    pub fn simpler(&self, values: &[f64]) -> Option<Vec<f64>> {
        let groups: Vec<_> = self.vanishing().collect();
        let simpler = self.instead(values, &groups, |own| own.neutral);
        (simpler != values).then_some(simpler)
    }

    /// Values of the simpler law without a parameter, and without those that go with it.
    pub fn without(&self, values: &[f64], index: usize) -> Vec<f64> {
        let own = self.parameters[index].name;
        let groups: Vec<_> = self
            .vanishing()
            .filter(|names| names.contains(&own))
            .collect();
        self.instead(values, &groups, |own| own.neutral)
    }

    /// Values of the fuller laws: with typical values of all parameters that it is without, then of those that go together.
    pub fn fuller(&self, values: &[f64], scales: &Scales) -> Vec<Vec<f64>> {
        let is_missing = |names: &&[&str]| {
            let index = self.parameters.iter().position(|own| names[0] == own.name);
            index.is_some_and(|index| self.is_without(index, values[index]))
        };
        let missing: Vec<_> = self.vanishing().filter(is_missing).collect();
        let with = |groups: &[&[&str]]| self.instead(values, groups, |own| (own.typical)(scales));
        let each = missing.chunks(1).filter(|_| missing.len() > 1);
        let all = std::iter::once(&missing[..]).filter(|all| !all.is_empty());
        all.chain(each).map(with).collect()
    }

    /// The parameters that the law may be without, those that go together.
    fn vanishing(&self) -> impl Iterator<Item = &'static [&'static str]> {
        self.properties.iter().filter_map(|own| match own {
            Property::Vanish(names) => Some(*names),
            _ => None,
        })
    }

    /// Values with others for the parameters of these names.
    fn instead(
        &self,
        values: &[f64],
        groups: &[&[&str]],
        other: impl Fn(&Parameter) -> f64,
    ) -> Vec<f64> {
        let is_changed = |own: &Parameter| groups.iter().any(|names| names.contains(&own.name));
        let pairs = self.parameters.iter().zip(values);
        pairs
            .map(|(own, &value)| if is_changed(own) { other(own) } else { value })
            .collect()
    }

    /// Whether its law may be without the parameter of an index.
    pub fn may_be_without(&self, index: usize) -> bool {
        let own = self.parameters[index].name;
        self.vanishing().any(|names| names.contains(&own))
    }

    /// Whether it may act again, at another time or in another recording.
    pub fn recurs(&self) -> bool {
        self.is(|own| matches!(own, Property::Recurs))
    }

    /// Index of the time of an event, which may recur; `None` for other effects.
    pub fn event_time(&self) -> Option<usize> {
        let time = || self.index(ParameterRole::Time);
        self.recurs().then(time).flatten()
    }

    /// Whether it belongs to one recording rather than to the machine: it acts from an instant on, comes from outside with a
    /// phase of its own, or follows a curve over the recording's time.
    pub fn happens(&self) -> bool {
        let over_time = |slot: Slot| slot.coordinate() == super::Coordinate::Time;
        let learned = self.is_learned() && self.slot().is_some_and(over_time);
        let has = |role| self.index(role).is_some();
        let outside = self.places == [Place::Environment] && has(ParameterRole::Phase);
        learned || outside || has(ParameterRole::Time)
    }

    /// Whether a machine may have it more than once: it has its own instant, place, frequency or order.
    pub fn may_repeat(&self) -> bool {
        use ParameterRole::{Frequency, Order, Position, Time};
        let own =
            |parameter: &Parameter| matches!(parameter.role, Time | Position | Frequency | Order);
        self.parameters.iter().any(own)
    }

    /// Whether its sizes need continuation, from the one that acts least.
    pub fn has_many_minima(&self) -> bool {
        self.is(|own| matches!(own, Property::ManyMinima))
    }

    /// Whether its shape is learned: its parameters are the law's values at knots.
    pub fn is_learned(&self) -> bool {
        self.index(ParameterRole::Ordinate).is_some()
    }

    /// Its slot, if its law is a curve over one coordinate.
    pub fn slot(&self) -> Option<Slot> {
        self.properties.iter().find_map(|own| match own {
            Property::Slot(slot) => Some(*slot),
            _ => None,
        })
    }

    /// The learned law with its own knots, and with finer ones where it has such.
    pub fn resolutions(&'static self) -> impl Iterator<Item = &'static Self> {
        let finer = self.properties.iter().find_map(|own| match own {
            Property::Finer(finer) => Some(*finer),
            _ => None,
        });
        std::iter::once(self).chain(finer)
    }

    /// Whether it is a damper between link and ground.
    pub fn damps_to_ground(&self) -> bool {
        self.is(|own| matches!(own, Property::DampsToGround))
    }

    /// Whether a sensor of positions in space cannot have it.
    pub fn is_of_deformation_only(&self) -> bool {
        self.is(|own| matches!(own, Property::OfDeformationOnly))
    }

    /// Whether it acts on a signal, of the drive or of a sensor, and not on the motion by a force.
    pub fn acts_on_signal(&self) -> bool {
        matches!((self.law)(&self.neutral()), Law::Drive(_) | Law::Sensor(_))
    }

    /// Whether it is equivalent to the offset of a clock.
    pub fn shifts_stamps(&self) -> bool {
        self.is(|own| matches!(own, Property::ShiftsStamps))
    }

    /// Whether it is a wrong scale of the sensor.
    pub fn is_wrong_scale(&self) -> bool {
        self.is(|own| matches!(own, Property::WrongScale))
    }
}
