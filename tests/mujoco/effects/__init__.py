"""What can be hidden: one class an effect, one table of all of them."""

from effects import environment, link, outside, sensor, transmission

EFFECTS = [*transmission.EFFECTS, *link.EFFECTS, *sensor.EFFECTS, *environment.EFFECTS, *outside.EFFECTS]

for module in (transmission, link, sensor, environment):
    for effect in module.EFFECTS:
        effect.place = effect.place or module.__name__.split(".")[-1]
