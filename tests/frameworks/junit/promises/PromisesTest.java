package promises;

import static org.junit.jupiter.api.Assertions.assertEquals;

import org.junit.jupiter.api.MethodOrderer;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.TestMethodOrder;
import org.junit.jupiter.api.TestReporter;

/** The cases of tests/frameworks/promises.json. */
@TestMethodOrder(MethodOrderer.MethodName.class)
class PromisesTest {
    @Test
    void first() {}

    @Test
    void second() throws Exception {
        var shell = new ProcessBuilder("sh", "-c", System.getenv("PROMISE")).inheritIO();
        assertEquals(0, shell.start().waitFor());
    }

    @Test
    void third(TestReporter reporter) {
        if (System.getenv("MEASURES") != null) {
            reporter.publishEntry("force", "2.5");
        }
    }
}
