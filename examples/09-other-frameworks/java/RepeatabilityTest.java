import static org.junit.jupiter.api.Assertions.assertEquals;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.PrintStream;
import java.net.Socket;
import java.nio.charset.StandardCharsets;
import org.junit.jupiter.api.Disabled;
import org.junit.jupiter.api.RepeatedTest;
import org.junit.jupiter.api.Tag;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.TestReporter;

/** JUnit: the wrist returns to the same position. */
class RepeatabilityTest {
    @RepeatedTest(3)
    @Tag("slow")
    void returnsToTheSamePosition(TestReporter reporter) throws Exception {
        move("wrist", 0.3);
        double there = move("wrist", 0.0);
        reporter.publishEntry("position", Double.toString(there));
        assertEquals(0.0, there, 0.05);
    }

    @Test
    @Disabled("the simulated arm has no load cell")
    void carriesALoad() {}

    /** Moves a joint, and returns its position after at most 5 s. */
    private static double move(String joint, double target) throws Exception {
        ask("set " + joint + " " + target);
        double position = Double.NaN;
        for (int tries = 0; tries < 500; tries++) {
            position = Double.parseDouble(ask("get " + joint));
            if (Math.abs(position - target) < 0.02) {
                break;
            }
            Thread.sleep(10);
        }
        return position;
    }

    private static String ask(String line) throws IOException {
        int port = Integer.parseInt(System.getenv("RTF_FIXTURE_ARM_PORT"));
        try (Socket socket = new Socket("127.0.0.1", port)) {
            new PrintStream(socket.getOutputStream(), true, StandardCharsets.UTF_8).print(line + "\n");
            var input = new InputStreamReader(socket.getInputStream(), StandardCharsets.UTF_8);
            String answer = new BufferedReader(input).readLine();
            if (answer == null || !answer.startsWith("ok")) {
                throw new IOException(line + ": " + answer);
            }
            return answer.length() > 3 ? answer.substring(3) : "";
        }
    }
}
