package example;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertTrue;

import java.util.stream.Stream;
import org.junit.jupiter.api.DynamicNode;
import org.junit.jupiter.api.DynamicTest;
import org.junit.jupiter.api.RepeatedTest;
import org.junit.jupiter.api.TestFactory;
import org.junit.jupiter.params.ParameterizedTest;
import org.junit.jupiter.params.provider.CsvSource;
import org.junit.jupiter.params.provider.ValueSource;

class SpeedTest {
    @ParameterizedTest
    @ValueSource(ints = {1, 2, 3})
    void isOdd(int speed) {
        assertEquals(1, speed % 2, "speed " + speed); // line: isOdd
    }

    @ParameterizedTest(name = "{0} to {1}")
    @CsvSource({"a/b, 'c, d'", "'[x]', \"y\""})
    void names(String from, String to) {
        assertTrue(from.length() > 1);
    }

    @RepeatedTest(3)
    void repeats() {}

    @TestFactory
    Stream<DynamicNode> makes() {
        return Stream.of("one", "two")
                .map(name -> DynamicTest.dynamicTest(name, () -> assertEquals("one", name))); // line: makes
    }
}
