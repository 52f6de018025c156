// What the sticks of a headset's controllers ask for: the left one walks, the right one turns and walks ahead; one alone
// does what the right one does.
const kDeadZone = 0.2, // what is less is a thumb at rest
    kTurn = Math.PI / 6, // at once: to be turned smoothly makes people sick
    kTurnPush = 0.7; // and it turns again once it was let go

export class Sticks {
    constructor(session) {
        this.session = session;
        this.hasTurned = false;
    }

    // Of 1 at most to the right and ahead, and radians to the left.
    read() {
        let right = 0,
            ahead = 0,
            push = 0;
        for (const { gamepad, handedness } of this.session.inputSources) {
            const [x = 0, y = 0] = [...(gamepad?.axes ?? [])].slice(-2); // those of a touch pad come before
            if (Math.abs(y) > kDeadZone) ahead -= y;
            if (handedness !== 'left') push += x;
            else if (Math.abs(x) > kDeadZone) right += x;
        }
        const turns = Math.abs(push) > kTurnPush && !this.hasTurned;
        if (turns || Math.abs(push) < kDeadZone) this.hasTurned = turns;
        const clamp = (value) => Math.min(1, Math.max(-1, value));
        return { right: clamp(right), ahead: clamp(ahead), left: turns ? -Math.sign(push) * kTurn : 0 };
    }
}
