package example;

import static org.junit.jupiter.api.Assertions.assertAll;
import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertThrows;
import static org.junit.jupiter.api.Assertions.assertTrue;
import static org.junit.jupiter.api.Assumptions.assumeTrue;

import java.nio.file.Files;
import java.util.Map;
import org.junit.jupiter.api.Disabled;
import org.junit.jupiter.api.DisplayName;
import org.junit.jupiter.api.MediaType;
import org.junit.jupiter.api.Nested;
import org.junit.jupiter.api.Tag;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.TestReporter;

@Tag("arm")
class ArmTest {
    @Test
    void moves() {
        assertEquals(4, 2 + 2);
    }

    @Test
    void fails() {
        assertEquals(0.5, 0.25, 0.01, "the elbow <is> \"off\" & late"); // line: fails
    }

    @Test
    void differsInLines() {
        assertEquals("first\nsecond\n", "first\nthird\n"); // line: differsInLines
    }

    @Test
    void failsInHelper() {
        Checks.isClosed(true); // line: failsInHelper
    }

    @Test
    void hasTwoFailures() {
        assertAll( // line: hasTwoFailures
                () -> assertTrue(false, "left"),
                () -> assertTrue(false, "right"));
    }

    @Test
    void throwsException() {
        Object nothing = null;
        nothing.toString(); // line: throwsException
    }

    @Test
    void throwsWithCause() {
        try {
            Integer.parseInt("seven");
        } catch (NumberFormatException problem) {
            throw new IllegalStateException("no speed", problem); // line: throwsWithCause
        }
    }

    @Test
    void expectsException() {
        assertThrows(IllegalArgumentException.class, () -> Integer.parseInt("x"));
    }

    @Test
    @Disabled("no gripper")
    void isDisabled() {}

    @Test
    @Disabled
    void isDisabledWithoutReason() {}

    @Test
    void isAborted() {
        assumeTrue(false, "no arm here");
    }

    @Test
    @Tag("slow")
    @DisplayName("Überprüft, ob „Arm“ (links/rechts) [1] 'x, y' \"z\" ist ✓")
    void hasDisplayName() {}

    @Test
    void prints() {
        System.out.println("to stdout: <ä> ]]>");
        System.err.println("to stderr");
        System.out.print("without end");
    }

    @Test
    void publishes(TestReporter reporter) {
        reporter.publishEntry("speed", "0.75");
        reporter.publishEntry("state", "ready, \"set\"");
        reporter.publishEntry(Map.of("force", "12"));
        reporter.publishEntry("plain value");
        reporter.publishFile("pose.txt", MediaType.TEXT_PLAIN, file -> Files.writeString(file, "1 2 3"));
    }

    @Nested
    @DisplayName("at rest")
    class AtRest {
        @Test
        void staysInNested() {}

        @Test
        void failsInNested() {
            assertTrue(false, "it moved"); // line: failsInNested
        }
    }
}
