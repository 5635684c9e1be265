"""Rule press: a press in time on a design, or on a contact beside those, as data."""

from pathlib import Path

from storage.netcdf import write_whole
from workflow.design.verdict import leftout, netcdf
from workflow.device import pressed
from workflow.study import planned, signal_case

snakemake, config = planned.start(globals())
assert config.signal is not None  # the rule is of studies that have it
if config.signal.case:
    contact = signal_case.of(config)
    shown = pressed.signal(contact, config.signal, contact.fixed)
    shown = shown.merge(pressed.held(contact, config.signal)).merge(
        pressed.spread(contact, config.signal, contact.fixed)
    )
    held = {**contact.fixed, contact.kind.loads.force: config.signal.force / pressed.length(contact)}
    noise, band = float(shown["noise_force"]), float(shown["charge_spread"])
    single = leftout.of_study(contact, held, noise, band, config.signal.hold)
    shown = shown.merge(netcdf.left_out(leftout.budget(single)))
else:
    answer = netcdf.read(Path(snakemake.input[0]))
    case = {**config.fixed, **answer.combination, **answer.case}
    shown = pressed.signal(config.narrowed(answer.combination), config.signal, case)
write_whole(shown, snakemake.output[0])
