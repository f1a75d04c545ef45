package descendants;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertFalse;
import static org.junit.jupiter.api.Assertions.assertTrue;
import static org.junit.platform.engine.discovery.DiscoverySelectors.selectClass;

import java.nio.file.Files;
import java.nio.file.Path;
import org.junit.jupiter.api.Test;
import org.junit.platform.launcher.core.LauncherDiscoveryRequestBuilder;
import org.junit.platform.launcher.core.LauncherFactory;
import org.junit.platform.launcher.listeners.SummaryGeneratingListener;

/** Cases that start processes, see tests/frameworks/descendants. */
class DescendantsTest {
    /** In the environment of a descendant: whether its cases `pass` or `fail`. */
    private static final String ROLE = System.getenv("DESCENDANT_ROLE");

    record End(int code, String output) {}

    /** Executes this program again with its arguments. */
    private static End execute(String role, boolean hasEnvironment) throws Exception {
        var arguments = Files.readString(Path.of("/proc/self/cmdline")).split("\0");
        var builder = new ProcessBuilder(arguments).redirectErrorStream(true);
        if (!hasEnvironment) {
            builder.environment().clear();
        }
        builder.environment().put("DESCENDANT_ROLE", role);
        var process = builder.start();
        process.getOutputStream().close();
        var output = new String(process.getInputStream().readAllBytes());
        return new End(process.waitFor(), output);
    }

    /** In a descendant, all cases have the same result. */
    private static boolean isDescendant() {
        if (ROLE != null) {
            System.out.println("a descendant prints");
            assertEquals("pass", ROLE);
        }
        return ROLE != null;
    }

    @Test
    void executesItself() throws Exception {
        assertTrue(isDescendant() || execute("pass", true).code() == 0);
    }

    @Test
    void needsADescendantThatFails() throws Exception {
        assertTrue(isDescendant() || execute("fail", true).code() == 0);
    }

    @Test
    void readsWhatADescendantPrints() throws Exception {
        if (!isDescendant()) {
            var end = execute("fail", false);
            System.out.println(end.output());
            assertEquals(1, end.code());
            assertTrue(end.output().contains("a descendant prints"));
        }
    }

    @Test
    void startsAProcessThatAborts() throws Exception {
        var shell = new ProcessBuilder("sh", "-c", "kill -ABRT $$");
        assertTrue(isDescendant() || shell.start().waitFor() == 128 + 6);
    }

    /** The results of the inner run are no results of this one. */
    @Test
    void runsJUnitInJUnit() {
        if (!isDescendant()) {
            var listener = new SummaryGeneratingListener();
            var request =
                    LauncherDiscoveryRequestBuilder.request()
                            .selectors(selectClass(Inner.class))
                            .build();
            LauncherFactory.create().execute(request, listener);
            assertEquals(1, listener.getSummary().getTestsSucceededCount());
            assertEquals(1, listener.getSummary().getTestsFailedCount());
        }
    }

    @Test
    void passes() {
        isDescendant();
    }

    @Test
    void fails() {
        assertTrue(isDescendant());
    }

    /** No name of a test class: the outer run does not find it. */
    static class Inner {
        @Test
        void innerPasses() {}

        @Test
        void innerFails() {
            assertFalse(true);
        }
    }
}
