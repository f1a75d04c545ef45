package example;

import static org.junit.jupiter.api.Assertions.assertFalse;

final class Checks {
    private Checks() {}

    static void isClosed(boolean open) {
        assertFalse(open, "the gripper is open");
    }
}
