"""Which relief is best? The worst dynamic factor over the speeds, for each relief."""
import gearsweep

text = """
&case   tasks = 'sweep' /
&pair   module_mm = 3  face_width_mm = 20 /
&pinion teeth = 21 /
&gear   teeth = 34 /
&load   torque_nm = 100 /
&relief amount_um = 0, 10, 20 /
&sweep  rpm_first = 1000  rpm_last = 15000  rpm_step = 500 /
"""
study = gearsweep.run(gearsweep.Case(text))
worst = study.sweep_worst
for relief, factor, rpm in zip(worst.relief_um, worst.worst_dynamic_factor, worst.rpm):
    print(f'{relief:5.1f} um: worst dynamic factor{factor:8.4f} at{rpm:8.1f} rpm')
