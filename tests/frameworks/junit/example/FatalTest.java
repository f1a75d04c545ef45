package example;

import java.lang.reflect.Field;
import org.junit.jupiter.api.MethodOrderer;
import org.junit.jupiter.api.Order;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.TestMethodOrder;

@TestMethodOrder(MethodOrderer.OrderAnnotation.class)
class FatalTest {
    @Test
    @Order(1)
    void first() {}

    @Test
    @Order(2)
    void exits() {
        System.out.println("about to exit");
        System.exit(0);
    }

    @Test
    @Order(3)
    void halts() {
        Runtime.getRuntime().halt(3);
    }

    @Test
    @Order(4)
    void crashes() throws ReflectiveOperationException {
        Field field = sun.misc.Unsafe.class.getDeclaredField("theUnsafe");
        field.setAccessible(true);
        ((sun.misc.Unsafe) field.get(null)).putAddress(0, 1);
    }

    @Test
    @Order(5)
    void isKilled() throws Exception {
        new ProcessBuilder("kill", "-KILL", String.valueOf(ProcessHandle.current().pid())).start().waitFor();
        Thread.sleep(60_000);
    }

    @Test
    @Order(6)
    void hangs() throws InterruptedException {
        waitForRobot();
    }

    @Test
    @Order(7)
    void last() {}

    private static void waitForRobot() throws InterruptedException {
        Thread.sleep(1_000_000_000);
    }
}
