package example;

import static org.junit.Assert.assertEquals;
import static org.junit.Assume.assumeTrue;

import org.junit.Ignore;
import org.junit.Test;

public class OldTest {
    @Test
    public void passes() {}

    @Test
    public void fails() {
        assertEquals("open", "closed"); // line: OldTest.fails
    }

    @Test
    @Ignore("too old")
    public void isIgnored() {}

    @Test
    public void isAssumed() {
        assumeTrue("no simulator", false);
    }
}
