"""The four-bar in MuJoCo with ideal joints: reaction forces of one settled cycle."""

import mujoco
from four_bar import COUPLER, COUPLER_MASS, CRANK, GROUND, ROCKER, ROCKER_MASS, SPEED, reply, start_angles, start_rates

from hingewise.cycle import serve

STEPS = 2000  # in a cycle
SETTLING = 1  # cycles; the constraint that closes the loop is soft
EVERY = 4  # step that is returned


def rod(mass, length):
    inertia = mass * length**2 / 12
    return f'<inertial pos="{length / 2} 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>'


def model(period):
    step = period / STEPS
    return f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{step}" gravity="0 0 0" integrator="RK4" solver="Newton" tolerance="1e-14" iterations="100"/>
  <worldbody>
    <body name="crank">
      <joint name="crank" axis="0 0 1" armature="1e6"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="coupler" pos="{CRANK} 0 0">
        <joint name="coupler" axis="0 0 1"/>
        {rod(COUPLER_MASS, COUPLER)}
      </body>
    </body>
    <body name="rocker" pos="{GROUND} 0 0">
      <joint name="rocker" axis="0 0 1"/>
      {rod(ROCKER_MASS, ROCKER)}
    </body>
  </worldbody>
  <equality>
    <connect name="loop" body1="rocker" body2="coupler" anchor="{ROCKER} 0 0" solref="{2 * step} 1" solimp="0.9999 0.9999 0.001"/>
  </equality>
</mujoco>"""


def cycle(request):
    period, torque = request["period"], request["sample"]["load_torque"]
    mech = mujoco.MjModel.from_xml_string(model(period))
    # The anchor is closed in the position of reference, all angles zero: its place on the coupler is set.
    mech.eq_data[0, :6] = ROCKER, 0, 0, COUPLER, 0, 0
    state = mujoco.MjData(mech)
    coupler, rocker = start_rates()
    state.qpos[:] = 0.0, *start_angles()
    state.qvel[:] = SPEED, coupler - SPEED, rocker
    state.qfrc_applied[2] = torque
    time, angles, forces = [], [], []
    for step in range((SETTLING + 1) * STEPS + 1):
        if step >= SETTLING * STEPS and step % EVERY == 0:
            mujoco.mj_forward(mech, state)
            mujoco.mj_rnePostConstraint(mech, state)
            crank, relative, rocking = state.qpos
            speed = abs(state.qvel[2] - state.qvel[0] - state.qvel[1])
            time.append((step - SETTLING * STEPS) * period / STEPS)
            angles.append((crank, crank + relative, rocking, speed))
            of_frame, of_crank = (state.cfrc_int[mech.body(name).id][3:5] for name in ("rocker", "coupler"))
            forces.append((tuple(of_crank), tuple(state.efc_force[:2]), tuple(of_frame)))
        mujoco.mj_step(mech, state)
    return reply(time, angles, forces)


if __name__ == "__main__":
    serve(cycle)
