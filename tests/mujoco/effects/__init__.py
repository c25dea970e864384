"""What can be hidden: one class an effect; the mixture draws from EFFECTS, a chosen kind also from LAWS or SHAPED."""

from effects import environment, laws, link, outside, sensor, shaped, transmission

EFFECTS = [*transmission.EFFECTS, *link.EFFECTS, *sensor.EFFECTS, *environment.EFFECTS, *outside.EFFECTS]
LAWS, SHAPED = laws.EFFECTS, shaped.EFFECTS

for module in (transmission, link, sensor, environment):
    for effect in module.EFFECTS:
        effect.place = effect.place or module.__name__.split(".")[-1]
