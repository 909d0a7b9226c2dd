# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages in German: reports, errors, reasons, hints. Templates are English as in the source, with `{}` for values.

See `telling`. The German numbers the values, `{0}`, `{1}`; names in single quotes are values like others.
"""

_COUNTED = {
    "{} area": "{0} Gebiet",
    "{} areas": "{0} Gebiete",
    "{} body": "{0} Körper",
    "{} bodies": "{0} Körper",
    "{} cap": "{0} Deckel",
    "{} caps": "{0} Deckel",
    "{} cut line": "{0} Schnittlinie",
    "{} cut lines": "{0} Schnittlinien",
    "{} face": "{0} Fläche",
    "{} faces": "{0} Flächen",
    "{} gap": "{0} Lücke",
    "{} gaps": "{0} Lücken",
    "{} hidden hole": "{0} ausgeblendetes Loch",
    "{} hidden holes": "{0} ausgeblendete Löcher",
    "{} hole": "{0} Loch",
    "{} holes": "{0} Löcher",
    "{} outer border": "{0} äußerer Rand",
    "{} outer borders": "{0} äußere Ränder",
    "{} irregular vertex": "{0} unregelmäßiger Punkt",
    "{} irregular vertices": "{0} unregelmäßige Punkte",
    "{} layer": "{0} Ebene",
    "{} layers": "{0} Ebenen",
    "{} patch": "{0} Flicken",
    "{} patches": "{0} Flicken",
    "{} piece": "{0} Stück",
    "{} pieces": "{0} Stücke",
    "{} quad": "{0} Viereck",
    "{} quads": "{0} Vierecke",
    "{} selection": "{0} Auswahl",
    "{} selections": "{0} Auswahlen",
    "{} sheet": "{0} Blatt",
    "{} sheets": "{0} Blätter",
    "{} stroke": "{0} Strich",
    "{} strokes": "{0} Striche",
    "{} triangle": "{0} Dreieck",
    "{} triangles": "{0} Dreiecke",
    "{} outline": "{0} Umriss",
    "{} outlines": "{0} Umrisse",
}

_COMMON = {
    "... and {} more": "... und {0} weitere",
    "{} (and {} more)": "{0} (und {1} weitere)",
    "{} and {}": "{0} und {1}",
    "{} and {} more": "{0} und {1} weitere",
    "{} left open": "{0} offen gelassen",
    "{} left out:": "{0} weggelassen:",
    "Meshed {} anew: {}, {}, {} ms": "{0} neu vernetzt: {1}, {2}, {3} ms",
    "Only vertices are selected; select faces, or a closed loop of edges": (
        "Nur Punkte sind ausgewählt; Flächen auswählen, oder eine geschlossene Schleife von Kanten"
    ),
    "Nothing is selected; select faces, or a closed loop of edges": (
        "Nichts ist ausgewählt; Flächen oder eine geschlossene Schleife aus Kanten auswählen"
    ),
    "Edit a mesh and select faces, or a closed loop of edges": (
        "Ein Mesh bearbeiten und Flächen oder eine geschlossene Schleife aus Kanten auswählen"
    ),
    "Cancelled; nothing was changed": "Abgebrochen; nichts wurde geändert",
    "The mesh that is being edited is hidden; show it, or leave Edit Mode": (
        "Das bearbeitete Mesh ist verborgen; es einblenden oder den Bearbeitungsmodus verlassen"
    ),
    "the selected edges enclose no area; select a closed loop of edges, or faces": (
        "die ausgewählten Kanten umschließen kein Gebiet; eine geschlossene Schleife aus Kanten oder Flächen auswählen"
    ),
    "it would have an edge that another area gets, too; choose them one after the other": (
        "es hätte eine Kante, die auch ein anderes Gebiet bekommt; eines nach dem anderen auswählen"
    ),
    "{} ms": "{0} ms",
    "{}   Esc: Stop": "{0}   Esc: Abbrechen",
    "{}   Stopping": "{0}   Wird abgebrochen",
}

_STROKES = {
    "'{}' has no curves; draw a closed shape in it": (
        "'{0}' hat keine Kurven; eine geschlossene Form darin zeichnen"
    ),
    "'{}' has no drawing at the current frame; go to a frame that has one": (
        "'{0}' hat im aktuellen Bild keine Zeichnung; zu einem Bild gehen, das eine hat"
    ),
    "'{}' has no layers; draw a closed shape in it": (
        "'{0}' hat keine Ebenen; eine geschlossene Form darin zeichnen"
    ),
    "'{}' has no splines of two or more points; draw a closed shape in it": (
        "'{0}' hat keine Splines aus zwei oder mehr Punkten; eine geschlossene Form darin zeichnen"
    ),
    "'{}' has no text; draw a closed shape in it": (
        "'{0}' hat keinen Text; eine geschlossene Form darin zeichnen"
    ),
    "'{}' has shape keys, which fit no new mesh; remove them or turn off Update Existing": (
        "'{0}' hat Formschlüssel, die zu keinem neuen Mesh passen; sie entfernen oder „Vorhandene aktualisieren“ "
        "ausschalten"
    ),
    "'{}' is being edited; leave its mode or turn off Update Existing": (
        "'{0}' wird gerade bearbeitet; den Modus verlassen oder „Vorhandene aktualisieren“ ausschalten"
    ),
    "'{}' is linked from another file; make it local or turn off Update Existing": (
        "'{0}' ist aus einer anderen Datei verknüpft; lokal machen oder „Vorhandene aktualisieren“ ausschalten"
    ),
    "'{}', layer '{}'": "'{0}', Ebene '{1}'",
    "'{}', layer '{}', stroke {} of {}": "'{0}', Ebene '{1}', Strich {2} von {3}",
    "'{}', stroke {} of {}": "'{0}', Strich {1} von {2}",
    "Cancelled; nothing was made": "Abgebrochen; nichts wurde gemacht",
    "Select a grease pencil, curve or text object with closed strokes": (
        "Ein Grease-Pencil-, Kurven- oder Textobjekt mit geschlossenen Strichen auswählen"
    ),
    "A stroke is painted; bodies have the colour of the material instead": (
        "Ein Strich ist bemalt; Körper haben stattdessen die Farbe des Materials"
    ),
    "{} strokes are painted; bodies have the colour of the material instead": (
        "{0} Striche sind bemalt; Körper haben stattdessen die Farbe des Materials"
    ),
    "all layers of '{}' are hidden; show the one to use": (
        "alle Ebenen von '{0}' sind ausgeblendet; die gemeinte zeigen"
    ),
    "all splines of '{}' are hidden; show the one to use": (
        "alle Splines von '{0}' sind ausgeblendet; den gemeinten zeigen"
    ),
    "it has 1 distinct point, at least 3 are needed; draw a closed shape": (
        "er hat nur 1 Punkt, mindestens 3 sind nötig; eine geschlossene Form zeichnen"
    ),
    "it has no points; draw a closed shape": "er hat keine Punkte; eine geschlossene Form zeichnen",
    "it has {} distinct points, at least 3 are needed; draw a closed shape": (
        "er hat {0} verschiedene Punkte, mindestens 3 sind nötig; eine geschlossene Form zeichnen"
    ),
    "it is a Bezier stroke without handles; set its handle type to Automatic or its type to Poly": (
        "er ist ein Bézier-Strich ohne Griffe; den Grifftyp auf Automatisch oder den Typ auf Poly setzen"
    ),
    "it is a straight line; draw a closed shape": "er ist eine gerade Linie; eine geschlossene Form zeichnen",
    "it is open: its ends are {} apart; make the stroke cyclic or raise Close Gaps from {} to {}": (
        "er ist offen: seine Enden sind {0} voneinander entfernt; den Strich zyklisch machen oder „Lücken schließen“ "
        "von {1} auf {2} erhöhen"
    ),
    "it is {} across, at least {} is needed; scale it up": (
        "er ist {0} groß, mindestens {1} ist nötig; ihn größer skalieren"
    ),
    "it lies inside another stroke and is a hole there; turn off Holes to make a body of it": (
        "er liegt in einem anderen Strich und ist dort ein Loch; „Löcher“ ausschalten, um einen Körper daraus zu machen"
    ),
    "it reaches to {}, coordinates up to {} are supported; scale it down or move it to the world origin": (
        "er reicht bis {0}, Koordinaten bis {1} werden unterstützt; ihn kleiner skalieren oder zum Weltursprung rücken"
    ),
    "its NURBS knots are of a kind that is not read; set the curve type to Poly or Bezier": (
        "NURBS-Knoten dieser Art werden nicht gelesen; den Kurventyp auf Poly oder Bézier setzen"
    ),
    "its edges branch; turn off the modifiers or options that make faces of it": (
        "seine Kanten verzweigen sich; die Modifikatoren oder Optionen ausschalten, die Flächen daraus machen"
    ),
    "its modifiers make a closed surface of it, which has no outline; turn them off": (
        "seine Modifikatoren machen eine geschlossene Fläche daraus, die keinen Umriss hat; sie ausschalten"
    ),
    "its stroke ({}, stroke {}) is gone or hidden; select the drawing instead": (
        "sein Strich ({0}, Strich {1}) fehlt oder ist ausgeblendet; stattdessen die Zeichnung auswählen"
    ),
    "material '{}' was there and is used with its own colour": (
        "Material '{0}' gab es schon; es wird mit seiner eigenen Farbe verwendet"
    ),
    "modifiers hide which strokes are selected; set Use to All, or apply the modifiers": (
        "Modifikatoren verdecken, welche Striche ausgewählt sind; „Verwenden“ auf „Alle“ setzen oder die "
        "Modifikatoren anwenden"
    ),
    "no object with strokes is selected; select a drawing or a curve": (
        "kein Objekt mit Strichen ist ausgewählt; eine Zeichnung oder Kurve auswählen"
    ),
    "none of the strokes is selected or closed; select one in Edit Mode, or set Use to All": (
        "keiner der Striche ist ausgewählt oder geschlossen; im Bearbeitungsmodus einen auswählen oder „Verwenden“ "
        "auf „Alle“ setzen"
    ),
    "point {} of {} is not a finite number; delete it": (
        "Punkt {0} von {1} ist keine endliche Zahl; ihn löschen"
    ),
    "the active collection '{}' is hidden, excluded or linked; what was made is in '{}'": (
        "die aktive Sammlung '{0}' ist ausgeblendet, ausgeschlossen oder verknüpft; das Gemachte ist in '{1}'"
    ),
    "the collection '{}' of '{}' is hidden, excluded or linked; what was made of it is in '{}'": (
        "die Sammlung '{0}' von '{1}' ist ausgeblendet, ausgeschlossen oder verknüpft; das daraus Gemachte ist in '{2}'"
    ),
    "the scene has no annotations; draw some with the Annotate tool": (
        "die Szene hat keine Anmerkungen; welche mit dem Werkzeug „Anmerken“ zeichnen"
    ),
    "the visible layers of '{}' have no strokes; draw a closed shape in one": (
        "die sichtbaren Ebenen von '{0}' haben keine Striche; eine geschlossene Form in einer zeichnen"
    ),
    "the visible layers of the annotations have no strokes; draw with the Annotate tool": (
        "die sichtbaren Ebenen der Anmerkungen haben keine Striche; mit dem Werkzeug „Anmerken“ zeichnen"
    ),
    "{} cuts through itself; use a smaller depth or more triangles": (
        "{0} schneidet sich selbst; eine kleinere Tiefe oder mehr Dreiecke nehmen"
    ),
    "{} cut through themselves; use a smaller depth or more triangles": (
        "{0} schneiden sich selbst; eine kleinere Tiefe oder mehr Dreiecke nehmen"
    ),
    "{}: it crosses stroke {} and is no hole in it": "{0}: er kreuzt Strich {1} und ist kein Loch darin",
    "{}: it is a hole now; '{}' was made from it and is left as it is": (
        "{0}: er ist jetzt ein Loch; '{1}' wurde daraus gemacht und bleibt, wie es ist"
    ),
    "{}: not flat, up to {} from its plane; it was projected onto the plane": (
        "{0}: nicht eben, bis {1} von seiner Ebene entfernt; er wurde auf die Ebene projiziert"
    ),
    "{}: {}, {}, {} ms": "{0}: {1}, {2}, {3} ms",
    "{}; {} closed": "{0}; {1} geschlossen",
    "'{}' was changed by hand and is left as it is; delete it, press Rebuild from Outline in the panel Live "
    "Body, or turn off Update Existing": (
        "'{0}' wurde von Hand geändert und bleibt, wie es ist; löschen, im Panel „Lebender Körper“ auf „Neu aus "
        "dem Umriss“ drücken oder „Vorhandene aktualisieren“ ausschalten"
    ),
    "1 body lies hidden inside another; move it forward": (
        "1 Körper liegt verborgen in einem anderen; ihn nach vorn schieben"
    ),
    "1 body lies hidden inside another; move it forward, or turn on Holes to make a hole of it": (
        "1 Körper liegt verborgen in einem anderen; ihn nach vorn schieben oder „Löcher“ einschalten, um ein Loch "
        "daraus zu machen"
    ),
    "1 body lies hidden inside another; turn on Join Overlapping Strokes, which lets upper layers stand out": (
        "1 Körper liegt verborgen in einem anderen; „Überlappende Striche zusammenführen“ einschalten, das obere "
        "Ebenen hervortreten lässt"
    ),
    "{} bodies lie hidden inside others; move them forward": (
        "{0} Körper liegen verborgen in anderen; sie nach vorn schieben"
    ),
    "{} bodies lie hidden inside others; move them forward, or turn on Holes to make holes of them": (
        "{0} Körper liegen verborgen in anderen; sie nach vorn schieben oder „Löcher“ einschalten, um Löcher "
        "daraus zu machen"
    ),
    "{} bodies lie hidden inside others; turn on Join Overlapping Strokes, which lets upper layers stand out": (
        "{0} Körper liegen verborgen in anderen; „Überlappende Striche zusammenführen“ einschalten, das obere "
        "Ebenen hervortreten lässt"
    ),
    "1 body was there already and was updated; turn off Update Existing to make another": (
        "1 Körper war schon da und wurde aktualisiert; „Vorhandene aktualisieren“ ausschalten, um einen weiteren "
        "zu machen"
    ),
    "{} bodies were there already and were updated; turn off Update Existing to make another": (
        "{0} Körper waren schon da und wurden aktualisiert; „Vorhandene aktualisieren“ ausschalten, um weitere "
        "zu machen"
    ),
}

_ENTRIES = {
    "Make a smooth body with a clean mesh of triangles or quads from each closed annotation": (
        "Aus jeder geschlossenen Anmerkung einen glatten Körper mit sauberem Netz aus Dreiecken oder Vierecken machen"
    ),
    "Make a flat body with a rounded rim of each closed stroke, like a badge": (
        "Aus jedem geschlossenen Strich einen flachen Körper mit rundem Rand machen, wie eine Plakette"
    ),
    "Make a body of each closed stroke whose long limbs are round tubes": (
        "Aus jedem geschlossenen Strich einen Körper machen, dessen lange Glieder runde Röhren sind"
    ),
    "Make a round body of each closed stroke; a circle becomes a sphere": (
        "Aus jedem geschlossenen Strich einen runden Körper machen; ein Kreis wird zur Kugel"
    ),
    "Make a round body of each closed stroke, of quads in loops along the outline": (
        "Aus jedem geschlossenen Strich einen runden Körper machen, aus Vierecken in Schleifen am Umriss entlang"
    ),
    "Make a flat sheet of each closed stroke, of quads in loops along the outline": (
        "Aus jedem geschlossenen Strich ein flaches Blatt machen, aus Vierecken in Schleifen am Umriss entlang"
    ),
    "Make a flat sheet of each closed stroke, fine enough to be bent much": (
        "Aus jedem geschlossenen Strich ein flaches Blatt machen, fein genug für starkes Biegen"
    ),
    "Make a flat sheet of each closed stroke, coarse, for little bending": (
        "Aus jedem geschlossenen Strich ein flaches Blatt machen, grob, für wenig Biegen"
    ),
    "Make a flat sheet of each closed stroke whose halves are alike, for faces": (
        "Aus jedem geschlossenen Strich ein flaches Blatt machen, dessen Hälften gleich sind, für Gesichter"
    ),
    "Make a flat sheet of each closed stroke, for cut-out animation": (
        "Aus jedem geschlossenen Strich ein flaches Blatt machen, für Legetrick"
    ),
    "thinnest part: {} across": "dünnster Teil: {0} quer",
    "{} triangles of each side for 5": "{0} Dreiecke jeder Seite für 5",
    "{} quads of each side for 5": "{0} Vierecke jeder Seite für 5",
}

_LIVE = {
    "'{}' has a bevel, an extrusion or an offset; set them to 0 to let bodies follow it": (
        "'{0}' hat eine Fase, eine Extrusion oder einen Versatz; sie auf 0 setzen, damit Körper ihm folgen"
    ),
    "'{}' has no layer '{}' with strokes": "'{0}' hat keine Ebene '{1}' mit Strichen",
    "'{}' is empty": "'{0}' ist leer",
    "'{}' is no drawing": "'{0}' ist keine Zeichnung",
    "'{}': it is linked from another file": "'{0}': es ist aus einer anderen Datei verknüpft",
    "Select a body that is linked to its drawing": (
        "Einen Körper auswählen, der mit seiner Zeichnung verknüpft ist"
    ),
    "it has shape keys, which fit no new mesh": "er hat Formschlüssel, die zu keinem neuen Mesh passen",
    "it is being edited; leave its mode": "er wird gerade bearbeitet; den Modus verlassen",
    "it is linked from another file": "er ist aus einer anderen Datei verknüpft",
    "it was made by another version of GridMesh; press Adopt to make it anew with this one": (
        "er wurde von einer anderen Version von GridMesh gemacht; „Übernehmen“ drücken, um ihn mit dieser neu zu machen"
    ),
    "its drawing is gone": "seine Zeichnung fehlt",
    "its stroke is gone": "sein Strich fehlt",
    "its stroke is hidden, or lies inside another and is a hole there": (
        "sein Strich ist ausgeblendet, oder er liegt in einem anderen und ist dort ein Loch"
    ),
    "the stroke has become too large for its lattice": "der Strich ist zu groß für sein Gitter geworden",
    "the stroke has left its plane": "der Strich hat seine Ebene verlassen",
    "the stroke is too thin for quads this coarse; use more quads or shorter edges, or set Faces to Triangles": (
        "der Strich ist zu dünn für so grobe Vierecke; mehr Vierecke oder kürzere Kanten nehmen, oder „Flächen“ auf "
        "Dreiecke stellen"
    ),
    "the stroke is too thin for a mesh this coarse; use more triangles or shorter edges": (
        "der Strich ist zu dünn für ein so grobes Netz; mehr Dreiecke oder kürzere Kanten nehmen"
    ),
    "its mesh was changed by hand; Rebuild from Outline gives that up, Freeze keeps it": (
        "das Mesh wurde von Hand geändert; „Neu aus dem Umriss“ gibt das auf, „Einfrieren“ behält es"
    ),
    "Live bodies of GridMesh 0.1.0: {}. Outlines that are now inside their bodies: {}": (
        "Lebende Körper von GridMesh 0.1.0: {0}. Umrisse, die nun in ihren Körpern liegen: {1}"
    ),
}

_DRAW = {
    "Drew {}": "{0} gezeichnet",
    "Extended {}": "{0} erweitert",
    "Made a hole in {}": "Loch gemacht in {0}",
    "Trimmed {}": "{0} beschnitten",
    "Draw in a 3D view": "In einer 3D-Ansicht zeichnen",
    "Leave the mode: bodies are drawn in Object Mode": (
        "Den Modus verlassen: Körper werden im Objektmodus gezeichnet"
    ),
    "nothing would be left; delete the body instead": "nichts bliebe übrig; stattdessen den Körper löschen",
    "the plane is seen edge on; turn the view or choose another plane": (
        "die Ebene wird genau von der Kante gesehen; die Ansicht drehen oder eine andere Ebene wählen"
    ),
    "the stroke encloses nothing": "der Strich umschließt nichts",
    "the stroke is too short; drag to draw an outline": (
        "der Strich ist zu kurz; ziehen, um einen Umriss zu zeichnen"
    ),
    "Added {} as part": "{0} als Teil hinzugefügt",
    "{} a side": "{0} je Seite",
    "nothing is drawn; use the GridMesh Draw tool in a 3D view": (
        "nichts ist gezeichnet; das Werkzeug „GridMesh Zeichnen“ in einer 3D-Ansicht verwenden"
    ),
    "'{}' will be inside it: not visible": "'{0}' liegt dann darin: nicht sichtbar",
    "inside '{}': not visible; let it lie in front": "in '{0}': nicht sichtbar; davor legen",
    "inside '{}': not visible; use Plane: Surface": ("in '{0}': nicht sichtbar; „Ebene“ auf „Fläche“ setzen"),
    "nothing would be left of it": "nichts bliebe davon übrig",
    "the stroke leaves the plane; turn the view or choose another plane": (
        "der Strich verlässt die Ebene; die Ansicht drehen oder eine andere Ebene wählen"
    ),
    "the stroke lies inside '{}', which it does not extend": (
        "der Strich liegt in '{0}' und erweitert es nicht"
    ),
    "there is no body that it could be a part of": "da ist kein Körper, von dem er ein Teil sein könnte",
    "there is no body under the stroke to extend": "unter dem Strich ist kein Körper zum Erweitern",
    "there is no body under the stroke to take away from": (
        "unter dem Strich ist kein Körper, von dem er etwas wegnehmen könnte"
    ),
    "the matrix of the stroke is no frame: its axes must be unit vectors at right angles": (
        "die Matrix des Strichs ist kein Koordinatensystem: ihre Achsen müssen Einheitsvektoren in rechten "
        "Winkeln sein"
    ),
    "the stroke cannot be read: {}": "der Strich ist nicht lesbar: {0}",
    "the stroke is no longer known: it is remembered until Blender is closed; draw it again": (
        "der Strich ist nicht mehr bekannt: er wird behalten, bis Blender geschlossen wird; ihn neu zeichnen"
    ),
    "Select a live body that was drawn with the tool, in Object Mode": (
        "Im Objektmodus einen lebenden Körper auswählen, der mit dem Werkzeug gezeichnet wurde"
    ),
    "Simplified {}: {} points before, {} now": "{0} vereinfacht: vorher {1} Punkte, nun {2}",
    "it is hidden": "es ist ausgeblendet",
    "it has numbers that are not finite": "er hat Zahlen, die nicht endlich sind",
    "{} bytes are no table of three columns": "{0} Bytes sind keine Tabelle mit drei Spalten",
}

_CUTS = {
    "'{}' has no faces to cut": "'{0}' hat keine Flächen zum Schneiden",
    "'{}' has no thickness, since a scale of it is zero; set its scale": (
        "'{0}' hat keine Dicke, da eine Skalierung null ist; die Skalierung setzen"
    ),
    "'{}' is linked from another file; make it local first": (
        "'{0}' ist aus einer anderen Datei verknüpft; es erst lokal machen"
    ),
    "'{}' reaches farther than {}; scale it down": "'{0}' reicht weiter als {1}; kleiner skalieren",
    "A cut is drawn in a 3D view; start it from there": (
        "Ein Schnitt wird in einer 3D-Ansicht gezeichnet; von dort aus beginnen"
    ),
    "That was a click. {}": "Das war ein Klick. {0}",
    "Cancelled; nothing was cut": "Abgebrochen; nichts wurde geschnitten",
    "Click: keep this side    Enter or B: keep both    D: draw again    Esc: cancel": (
        "Klick: diese Seite behalten    Enter oder B: beide behalten    D: neu zeichnen    Esc: abbrechen"
    ),
    "Drag: draw the cut    Ctrl: straight line    Back to the start: closed cut    Esc: cancel": (
        "Ziehen: den Schnitt zeichnen    Strg: gerade Linie    Zurück zum Anfang: geschlossener Schnitt    "
        "Esc: abbrechen"
    ),
    "Make a mesh the active object, in Object or Edit Mode": (
        "Ein Mesh zum aktiven Objekt machen, im Objekt- oder Bearbeitungsmodus"
    ),
    "a cap would lie on a face of the mesh; move the stroke a little": (
        "ein Deckel läge auf einer Fläche des Mesh; den Strich etwas verschieben"
    ),
    "a side of the stroke has nothing of the mesh; draw the stroke across it": (
        "auf einer Seite des Strichs liegt nichts vom Mesh; den Strich quer darüber zeichnen"
    ),
    "a straight stroke lies in no plane of its own; set Direction to View or to the axis to cut along": (
        "ein gerader Strich liegt in keiner eigenen Ebene; „Richtung“ auf „Ansicht“ oder auf die Achse setzen, entlang "
        "der geschnitten wird"
    ),
    "cut along {}, the last one; set Stroke to use another": (
        "geschnitten an {0}, dem letzten; „Strich“ setzen, um einen anderen zu nehmen"
    ),
    "no stroke is selected; select a grease pencil or curve object, then the mesh, or draw the cut": (
        "kein Strich ist ausgewählt; ein Grease-Pencil- oder Kurvenobjekt auswählen, dann das Mesh, oder den Schnitt "
        "zeichnen"
    ),
    "point {} of the stroke is not a finite number; delete it": (
        "Punkt {0} des Strichs ist keine endliche Zahl; ihn löschen"
    ),
    "seen along the direction of the cut the stroke is a point; set Direction to another axis, or draw a longer stroke": (
        "in Richtung des Schnitts gesehen ist der Strich ein Punkt; „Richtung“ auf eine andere Achse setzen oder einen "
        "längeren Strich zeichnen"
    ),
    "smallest angle {}°": "kleinster Winkel {0}°",
    "the mesh of '{}' is being edited in another object; leave Edit Mode first": (
        "das Mesh von '{0}' wird gerade in einem anderen Objekt bearbeitet; erst den Bearbeitungsmodus verlassen"
    ),
    "the selected objects have no strokes; draw one": (
        "die ausgewählten Objekte haben keine Striche; einen zeichnen"
    ),
    "the stroke has no points; call this operator from a 3D view to draw one": (
        "der Strich hat keine Punkte; von einer 3D-Ansicht aus aufrufen, um einen zu zeichnen"
    ),
    "the stroke reaches behind the view; move the view back, or set Direction to an axis": (
        "der Strich reicht hinter die Ansicht; die Ansicht zurückbewegen oder „Richtung“ auf eine Achse setzen"
    ),
    "the stroke reaches farther than {}; scale it down": (
        "der Strich reicht weiter als {0}; ihn kleiner skalieren"
    ),
    "there is no material '{}'; choose another one, or none for an empty slot": (
        "es gibt kein Material '{0}'; ein anderes wählen, oder keines für einen leeren Platz"
    ),
    "there is no stroke {}: the selected objects have {}; lower Stroke": (
        "es gibt keinen Strich {0}: die ausgewählten Objekte haben {1}; „Strich“ verringern"
    ),
    "there is no view here: cut along the normal of the stroke's plane": (
        "hier ist keine Ansicht: geschnitten entlang der Normalen der Ebene des Strichs"
    ),
    "vertex {} of '{}' has a coordinate that is not a finite number; move or delete it": (
        "Punkt {0} von '{1}' hat eine Koordinate, die keine endliche Zahl ist; ihn verschieben oder löschen"
    ),
    "view_direction is zero; give the direction in which the view looks": (
        "view_direction ist null; die Blickrichtung angeben"
    ),
    "close the mesh first (Grid Patch Fill), or delete that wall, to get one": (
        "für einen Deckel erst das Mesh schließen (Loch mit Gitter füllen) oder diese Wand löschen"
    ),
    "{} are folded, since the mesh cuts through itself there": (
        "{0} sind gefaltet, da das Mesh sich dort selbst schneidet"
    ),
    "{} end at the border of the mesh, or at a wall inside it, and have no cap; {}": (
        "{0} enden am Rand des Mesh oder an einer Wand in ihm und haben keinen Deckel; {1}"
    ),
    "{} ends at the border of the mesh, or at a wall inside it, and has no cap; {}": (
        "{0} endet am Rand des Mesh oder an einer Wand in ihm und hat keinen Deckel; {1}"
    ),
    "{} is folded, since the mesh cuts through itself there": (
        "{0} ist gefaltet, da das Mesh sich dort selbst schneidet"
    ),
    "{} left open, since nothing of the mesh lies inside": (
        "{0} offen gelassen, da nichts vom Mesh darin liegt"
    ),
    "'{}' is left as it was: {}": "'{0}' bleibt, wie es war: {1}",
    "frozen, since a cut body cannot follow its drawing: {}": (
        "eingefroren, denn ein geschnittener Körper kann seiner Zeichnung nicht folgen: {0}"
    ),
    "'{}' has the same mesh as '{}' and is what that is; make it single-user to cut it by itself": (
        "'{0}' hat dasselbe Mesh wie '{1}' und ist, was jenes ist; zum Einzelnutzer machen, um es für sich zu schneiden"
    ),
    "{} lies flat, since it has holes, goes around a closed stroke or ends at a plane of symmetry; only others bulge": (
        "{0} ist flach, da er Löcher hat, um einen geschlossenen Strich läuft oder an einer Symmetrieebene endet; nur "
        "andere wölben sich"
    ),
    "{} lie flat, since they have holes, go around a closed stroke or end at a plane of symmetry; only others bulge": (
        "{0} sind flach, da sie Löcher haben, um einen geschlossenen Strich laufen oder an einer Symmetrieebene enden; "
        "nur andere wölben sich"
    ),
    "{} bulges less than the mesh around it, or lies flat; rounder, it would break through the mesh": (
        "{0} ist weniger gewölbt als das Mesh ringsum, oder flach; runder stieße er durch das Mesh"
    ),
    "{} bulge less than the mesh around them, or lie flat; rounder, they would break through the mesh": (
        "{0} sind weniger gewölbt als das Mesh ringsum, oder flach; runder stießen sie durch das Mesh"
    ),
    "The line crosses no selected mesh": "Die Linie kreuzt kein ausgewähltes Mesh",
    "{}    D: draw again    Esc: cancel": "{0}    D: neu zeichnen    Esc: abbrechen",
}

_BRIDGES = {
    "Cancelled; nothing was joined": "Abgebrochen; nichts wurde verbunden",
    "Edit a mesh and select two or more loops of open edges": (
        "Ein Mesh bearbeiten und zwei oder mehr Schleifen offener Kanten auswählen"
    ),
    "Joined {}: {}, {}, {} ms": "{0} verbunden: {1}, {2}, {3} ms",
    "Joined by {}: {}, {}, {} ms": "Verbunden durch {0}: {1}, {2}, {3} ms",
    "Joined {} by {}: {}, {}, {} ms": "{0} verbunden durch {1}: {2}, {3}, {4} ms",
    "1 loop is left over; pairs want an even number": "1 Schleife bleibt übrig; Paare brauchen eine gerade Anzahl",
    "a tube between two of the loops would meet the mesh or itself; select these two alone to join them all the same": (
        "eine Röhre zwischen zwei der Schleifen träfe das Mesh oder sich selbst; nur diese zwei auswählen, um sie trotzdem zu verbinden"
    ),
    "{} pair of loops": "{0} Schleifenpaar",
    "{} pairs of loops": "{0} Schleifenpaare",
    "No regular lattice suits these numbers of edges; choose other rows or subdivide a loop": (
        "Kein regelmäßiges Gitter passt zu diesen Anzahlen von Kanten; andere Reihen wählen oder eine Schleife unterteilen"
    ),
    "Rows and Twist are for two loops": "Reihen und Verdrehung gelten für zwei Schleifen",
    "The patch meets the mesh or itself; check the shape and which way the faces at the loops look": (
        "Der Flicken trifft das Mesh oder sich selbst; die Form prüfen, und wohin die Flächen an den Schleifen schauen"
    ),
    "The tube meets the mesh or itself; check the shape, or choose less smoothness": (
        "Die Röhre trifft das Mesh oder sich selbst; die Form prüfen oder weniger Glätte wählen"
    ),
    "UVs or colours are torn at the loops: continued from the longest stretch of each": (
        "UVs oder Farben sind an den Schleifen gerissen: vom jeweils längsten Stück fortgesetzt"
    ),
    "both loops pass through vertex {}; split it, or choose loops that are apart": (
        "beide Schleifen gehen durch Punkt {0}; ihn trennen oder Schleifen wählen, die getrennt sind"
    ),
    "{} of data not continued: a value at a loop is not finite": (
        "{0} mit Daten nicht fortgesetzt: ein Wert an einer Schleife ist nicht endlich"
    ),
    "{} of the loops pass through vertex {}; split it, or choose loops that are apart": (
        "{0} der Schleifen gehen durch Punkt {1}; ihn trennen oder Schleifen wählen, die getrennt sind"
    ),
    "some of the loops look away from each other, as both ends of a pipe do, and one patch would meet itself; choose Pairs "
    "under Loops": (
        "einige der Schleifen sehen voneinander weg, wie beide Enden eines Rohrs, und ein Flicken träfe sich selbst; unter "
        "Schleifen Paare wählen"
    ),
    "no triangles between these loops make one patch; subdivide the smallest, or join fewer at once": (
        "keine Dreiecke zwischen diesen Schleifen ergeben einen Flicken; die kleinste unterteilen, oder weniger auf einmal verbinden"
    ),
    "every tube repeats an edge of the mesh": "jede Röhre wiederholt eine Kante des Meshs",
    "{} at the loops look the other way than the tube; recalculate the normals": (
        "{0} an den Schleifen schauen anders herum als die Röhre; die Normalen neu berechnen"
    ),
    "{} at the loops look the other way than the patch; recalculate the normals": (
        "{0} an den Schleifen schauen anders herum als der Flicken; die Normalen neu berechnen"
    ),
    "{} loop": "{0} Schleife",
    "{} loops": "{0} Schleifen",
    "{} of open edges selected; select two or more to join": (
        "{0} offener Kanten ausgewählt; zwei oder mehr zum Verbinden auswählen"
    ),
    "{} row": "{0} Reihe",
    "{} rows": "{0} Reihen",
    # Of the library
    "a finite angle in radians": "ein endlicher Winkel im Bogenmaß",
    "a vertex is not finite": "ein Punkt ist nicht endlich",
    "a finite length, at least 0": "eine endliche Länge, mindestens 0",
    "a finite number of pixels above 0": "eine endliche Zahl von Pixeln über 0",
    "a finite number, at least 1": "eine endliche Zahl, mindestens 1",
    "1 or more": "1 oder mehr",
    "no step of a part was made": "kein Schritt eines Teils wurde gemacht",
    "a thread of a computation died": "ein Thread einer Berechnung ist abgebrochen",
    "a whole number above 0, or nothing": "eine ganze Zahl über 0, oder nichts",
    "given, with {} loops": "angegeben, bei {0} Schleifen",
    "no triangles between the loops are sound": "keine Dreiecke zwischen den Schleifen sind brauchbar",
    "none, with several loops": "keine, bei mehreren Schleifen",
    "one loop or more": "eine Schleife oder mehr",
    "the loops have too few vertices to be joined": "die Schleifen haben zu wenige Punkte, um verbunden zu werden",
    "a patch of a joint has vertices beyond its rims": "ein Übergang hat Punkte außerhalb seiner Ränder",
    "a path of a tube leaves it": "ein Weg einer Röhre verlässt sie",
    "two paths of a tube meet": "zwei Wege einer Röhre treffen sich",
}

_JOINS = {
    "'{}' has no faces to join": "„{0}“ hat keine Flächen zum Verbinden",
    "'{}' is not closed: it has {}; fill its holes or merge doubled vertices": (
        "„{0}“ ist nicht geschlossen: {1}; die Löcher füllen oder doppelte Punkte verschmelzen"
    ),
    "'{}' is not manifold: more than two faces meet at {}; delete the faces inside": (
        "„{0}“ ist nicht mannigfaltig: mehr als zwei Flächen treffen sich an {1}; die Flächen im Inneren löschen"
    ),
    "Joined {}: {}, {}, {} ms": "{0} verbunden: {1}, {2}, {3} ms",
    "Select closed meshes in Object Mode, one of them active; or one with pieces that overlap": (
        "Geschlossene Meshes im Objektmodus auswählen, eines davon aktiv; oder eines mit überlappenden Stücken"
    ),
    "'{}' is the only mesh, and none of its pieces overlap; select another one as well": (
        "„{0}“ ist das einzige Mesh, und keine Stücke davon überlappen; noch ein anderes auswählen"
    ),
    "{} with a crease, since there is no room for a transition; blend less, or give the parts shorter edges there": (
        "{0} mit einer Kante, weil für einen Übergang kein Platz ist; schmaler verbinden oder den Teilen dort kürzere Kanten geben"
    ),
    "{} with thin faces, as the surfaces cut each other; faces are too large there: subdivide the parts": (
        "{0} mit dünnen Flächen, wie sich die Oberflächen schneiden; die Flächen dort sind zu groß: die Teile unterteilen"
    ),
    "The joints meet the parts or themselves; blend less, move a part, or switch Strict on to refuse that": (
        "Die Übergänge treffen die Teile oder sich selbst; schmaler verbinden, einen Teil verschieben oder „Streng“ "
        "einschalten, um das abzulehnen"
    ),
    "'{}' has no part '{}'": "'{0}' hat keinen Teil '{1}'",
    "the part stays apart from '{}': {}": "der Teil bleibt getrennt von '{0}': {1}",
    "'{}' stays apart: {}": "'{0}' bleibt für sich: {1}",
    "Make a part of a joined body the active object": "Einen Teil eines zusammengeführten Körpers zum aktiven Objekt machen",
    "Make a joined body, or one of its parts, the active object": (
        "Einen zusammengeführten Körper oder einen seiner Teile zum aktiven Objekt machen"
    ),
    "its parts are gone; undo that, or apply the join": (
        "seine Teile sind nicht mehr da; das rückgängig machen oder das Zusammenführen anwenden"
    ),
    "its mesh was changed by hand; undo that, or apply the join": (
        "sein Mesh wurde von Hand geändert; das rückgängig machen oder das Zusammenführen anwenden"
    ),
    "The bodies stay apart: {}": "Die Körper bleiben getrennt: {0}",
    "frozen, since a joined body cannot follow its drawings: {}": (
        "eingefroren, denn ein verbundener Körper kann seinen Zeichnungen nicht folgen: {0}"
    ),
    "inside out, and turned round: {}": "von innen nach außen gekehrt und umgedreht: {0}",
    "overlapping pieces of meshes, joined like parts: {}": "überlappende Stücke von Meshes, wie Teile verbunden: {0}",
    "vertices added where faces met in one point or edge alone: {}": (
        "Vertices hinzugefügt, wo Flächen sich nur in einem Punkt oder einer Kante trafen: {0}"
    ),
    "joined without their modifiers: {}": "ohne ihre Modifikatoren verbunden: {0}",
    "the mesh of '{}' is being edited; leave Edit Mode first": (
        "das Mesh von „{0}“ wird bearbeitet; erst den Bearbeitungsmodus verlassen"
    ),
    "'{}' reaches farther than {}; scale it down or move it nearer": (
        "„{0}“ reicht weiter als {1}; kleiner skalieren oder näher heranrücken"
    ),
    "{} inside others left out": "{0} innerhalb anderer weggelassen",
    "{} without contact to others; moved into another one it would be joined": (
        "{0} ohne Berührung mit anderen; in einen anderen geschoben würde er verbunden"
    ),
    "{} edge": "{0} Kante",
    "{} edges": "{0} Kanten",
    "{} open edge": "{0} offene Kante",
    "{} open edges": "{0} offene Kanten",
    "{} joint": "{0} Übergang",
    "{} joints": "{0} Übergänge",
    "{} part": "{0} Teil",
    "{} parts": "{0} Teile",
    "{} polygon": "{0} Vieleck",
    "{} polygons": "{0} Vielecke",
}

_FILLS = {
    "Cancelled; nothing was filled": "Abgebrochen; nichts wurde gefüllt",
    "Edit a mesh and select the edges of a hole": "Ein Mesh bearbeiten und die Kanten eines Lochs auswählen",
    "Filled {}: {}, {}, {} ms": "{0} gefüllt: {1}, {2}, {3} ms",
    "There are no holes": "Es gibt keine Löcher",
    "UVs or colours are torn at {}: continued from the longest stretch of each": (
        "UVs oder Farben sind gerissen ({0}): vom jeweils längsten Stück fortgesetzt"
    ),
    "in another shape key {}": "in einem anderen Formschlüssel: {0}",
    "it has no thickness, since a scale of it is zero; set its scale and try again": (
        "es hat keine Dicke, da eine Skalierung null ist; die Skalierung setzen und es noch einmal versuchen"
    ),
    "none of the selected vertices lies on a hole; select a vertex or an edge of one": (
        "keiner der ausgewählten Punkte liegt an einem Loch; einen Punkt oder eine Kante eines Lochs auswählen"
    ),
    "nothing is selected; select the edges around a hole, or a vertex or an edge of it": (
        "nichts ist ausgewählt; die Kanten um ein Loch auswählen, oder einen Punkt oder eine Kante davon"
    ),
    "select the missing edges or select at least three edges": (
        "die fehlenden Kanten auswählen oder mindestens drei Kanten auswählen"
    ),
    "select the missing edges or turn on Close Chains": (
        "die fehlenden Kanten auswählen oder „Ketten schließen“ einschalten"
    ),
    "the edge between vertices {} and {}": "die Kante zwischen den Punkten {0} und {1}",
    "the edge between vertices {} and {} has no length; merge the vertices by distance": (
        "die Kante zwischen den Punkten {0} und {1} hat keine Länge; die Punkte nach Abstand zusammenfügen"
    ),
    "the hole of {} edges is hidden in part; reveal it first": (
        "das Loch aus {0} Kanten ist teils ausgeblendet; es erst einblenden"
    ),
    "the rim from vertex {} to {} does not close: more than two faces meet there; delete the surplus face": (
        "der Rand von Punkt {0} bis {1} schließt sich nicht: mehr als zwei Flächen treffen sich dort; die überzählige "
        "Fläche löschen"
    ),
    "the selected edges branch at vertex {}; deselect what does not belong to the loop": (
        "die ausgewählten Kanten verzweigen sich an Punkt {0}; abwählen, was nicht zur Schleife gehört"
    ),
    "the selected edges do not close: they end at vertices {} and {}; {}": (
        "die ausgewählten Kanten schließen sich nicht: sie enden an den Punkten {0} und {1}; {2}"
    ),
    "the selected edges form a figure eight that meets itself at vertex {}; fill its two loops one after the other": (
        "die ausgewählten Kanten bilden eine Acht, die sich an Punkt {0} trifft; ihre zwei Schleifen nacheinander füllen"
    ),
    "the selected loop touches itself at vertices {}; select one simple loop at a time": (
        "die ausgewählte Schleife berührt sich an den Punkten {0}; je eine einfache Schleife auswählen"
    ),
    "the wires close no loop": "die losen Kanten schließen keine Schleife",
    "two edges join vertices {} and {}; merge them": (
        "zwei Kanten verbinden die Punkte {0} und {1}; sie zusammenfügen"
    ),
    "vertex {} has a coordinate that is not a finite number; move or delete it": (
        "Punkt {0} hat eine Koordinate, die keine endliche Zahl ist; ihn verschieben oder löschen"
    ),
    "vertex {} is {} away, up to {} is supported; move or delete it": (
        "Punkt {0} ist {1} entfernt, bis {2} wird unterstützt; ihn verschieben oder löschen"
    ),
    "vertex {} lies on no hole; select a vertex or an edge of one": (
        "Punkt {0} liegt an keinem Loch; einen Punkt oder eine Kante eines Lochs auswählen"
    ),
    "{} around the holes is turned the other way than most; recalculate the normals": (
        "{0} um die Löcher ist anders herum gedreht als die meisten; die Normalen neu berechnen"
    ),
    "{} around the holes are turned the other way than most; recalculate the normals": (
        "{0} um die Löcher sind anders herum gedreht als die meisten; die Normalen neu berechnen"
    ),
    "{} has faces on both sides; select open edges only, or delete the faces that the patch shall replace": (
        "{0} hat Flächen auf beiden Seiten; nur offene Kanten auswählen, oder die Flächen löschen, die der Flicken "
        "ersetzen soll"
    ),
    "{} made by a simpler method, since the smooth one failed": (
        "{0} nach einem einfacheren Verfahren gemacht, da das glatte versagte"
    ),
    "{} meet the mesh or themselves; check the shape": "{0} schneiden das Mesh oder sich selbst; die Form prüfen",
    "{} meets the mesh or itself; check the shape": (
        "{0} schneidet das Mesh oder sich selbst; die Form prüfen"
    ),
    "{} of data not continued: a value at a hole is not finite": (
        "{0} mit Daten nicht fortgesetzt: ein Wert an einem Loch ist nicht endlich"
    ),
    "nothing is selected; select two or more loops of open edges": (
        "nichts ist ausgewählt; zwei oder mehr Schleifen offener Kanten auswählen"
    ),
    "the selected faces have no open edges; delete them and select the loops that are left": (
        "die ausgewählten Flächen haben keine offenen Kanten; sie löschen und die Schleifen auswählen, die bleiben"
    ),
    "the selected loops are of several objects; join these first (Ctrl-J)": (
        "die ausgewählten Schleifen gehören mehreren Objekten; diese zuerst verbinden (Strg-J)"
    ),
    "also changed, with the same mesh: {}": "mit demselben Mesh auch geändert: {0}",
    "hidden faces lie beside or within the area; reveal them first": (
        "verdeckte Flächen liegen neben oder in dem Gebiet; sie zuerst einblenden"
    ),
    "{} of the {} edges of a loop are selected; select all of them, or one that stands for the loop: rows of edges are "
    "not joined": (
        "{0} der {1} Kanten einer Schleife sind ausgewählt; alle auswählen, oder eine, die für die Schleife steht: Reihen "
        "von Kanten werden nicht verbunden"
    ),
    "{} left open, inside which the mesh lies already; select a border to fill it": (
        "{0} offen gelassen, worin das Mesh schon liegt; zum Füllen einen Rand auswählen"
    ),
    "{} left open at the plane of a Mirror modifier": "{0} an der Ebene eines Spiegeln-Modifikators offen gelassen",
    "{} left open across the plane of a Mirror modifier; apply the modifier to fill them whole": "{0} über die Ebene eines "
    "Spiegeln-Modifikators hinweg offen gelassen; wende ihn an, um sie ganz zu füllen",
    "{} lost shape: the new faces are up to {} edges of the border off, which are too long for what lies within; select "
    "less, or subdivide first": (
        "{0} mit verlorener Form: die neuen Flächen liegen bis zu {1} Kanten des Randes daneben, die für das, was darin "
        "liegt, zu lang sind; weniger auswählen oder zuerst unterteilen"
    ),
    "{} with more than {} edges left open; raise Max Edges": (
        "{0} mit mehr als {1} Kanten offen gelassen; „Höchstens Kanten“ erhöhen"
    ),
    "what is selected has no open edges; select an edge or a vertex of a hole": (
        "das Ausgewählte hat keine offenen Kanten; eine Kante oder einen Punkt eines Lochs auswählen"
    ),
    "{} made without hard edges: those at the hole meet in no line or corner": (
        "{0} ohne harte Kanten: die am Loch treffen sich in keiner Linie oder Ecke"
    ),
}

_QUALITY = {
    "4 edges or fewer": "4 Kanten oder weniger",
    "5 edges": "5 Kanten",
    "7 edges": "7 Kanten",
    "8 edges or more": "8 Kanten oder mehr",
    "Far too few edges": "Viel zu wenige Kanten",
    "Far too many edges": "Viel zu viele Kanten",
    "Irregular {}": "Unregelmäßig {0}",
    "Non-manifold {}": "Nicht mannigfaltig {0}",
    "Select a mesh object": "Ein Mesh-Objekt auswählen",
    "Sharpest angle {}°": "Spitzester Winkel {0}°",
    "Too few edges": "Zu wenige Kanten",
    "Too many edges": "Zu viele Kanten",
    "1 irregular vertex": "1 unregelmäßiger Punkt",
    "1 pole": "1 Pol",
    "{} poles": "{0} Pole",
    "Poles {}": "Pole {0}",
    "2 edges": "2 Kanten",
    "3 edges": "3 Kanten",
    "6 edges or more": "6 Kanten oder mehr",
    "sharpest angle {}°": "spitzester Winkel {0}°",
    "{}  (least {})": "{0}  (mindestens {1})",
    "{} (least {})": "{0} (mindestens {1})",
    "{} non-manifold places": "{0} nicht mannigfaltige Stellen",
}

_MODULE = {
    "Restart Blender to finish the update": "Blender neu starten, um die Aktualisierung abzuschließen",
    "The native module 'gridmesh' could not be loaded ({}); this is {} with Python {}: install the GridMesh zip for "
    "it again, and restart Blender": (
        "Das Modul 'gridmesh' ließ sich nicht laden ({0}); dies ist {1} mit Python {2}: das GridMesh-Zip dafür neu "
        "installieren und Blender neu starten"
    ),
    "The native module 'gridmesh' is missing; install the GridMesh zip for {} in Preferences > Get Extensions > "
    "Install from Disk": (
        "Das Modul 'gridmesh' fehlt; das GridMesh-Zip für {0} unter Einstellungen > Erweiterungen > Von Datenträger "
        "installieren einrichten"
    ),
    "The native module 'gridmesh' is {}, this extension needs {}": (
        "Das Modul 'gridmesh' ist {0}, diese Erweiterung braucht {1}"
    ),
    "The native module 'gridmesh' ({}, from {}) is an unfinished build without '{}'; install GridMesh {} again and "
    "restart Blender": (
        "Das Modul 'gridmesh' ({0}, aus {1}) ist unfertig, ihm fehlt '{2}'; GridMesh {3} neu installieren und Blender "
        "neu starten"
    ),
    "an unknown place": "unbekannter Stelle",
    "of unknown version": "von unbekannter Version",
    "{}: files of two versions of the native module 'gridmesh' are mixed ({})": (
        "{0}: Dateien zweier Versionen des Moduls 'gridmesh' sind vermischt ({1})"
    ),
    "{}: version {} of the native module 'gridmesh' is still loaded, this extension needs {}": (
        "{0}: Version {1} des Moduls 'gridmesh' ist noch geladen, diese Erweiterung braucht {2}"
    ),
    "{}; another extension has brought a newer one: update GridMesh, then restart Blender": (
        "{0}; eine andere Erweiterung hat eine neuere gebracht: GridMesh aktualisieren, dann Blender neu starten"
    ),
    "{}; install GridMesh {} again, then restart Blender": (
        "{0}; GridMesh {1} neu installieren, dann Blender neu starten"
    ),
}

# Errors of the Rust library.
_LIBRARY = {
    "point {} of the {} is NaN or infinite; all coordinates must be finite": (
        "Punkt {0} ({1}) ist keine Zahl oder unendlich; alle Koordinaten müssen endlich sein"
    ),
    "the {} has {} distinct points; at least 3 are needed, draw a closed shape": (
        "{0}: {1} verschiedene Punkte; mindestens 3 sind nötig, eine geschlossene Form zeichnen"
    ),
    "the {} encloses no area: its points lie on one line; draw a closed shape": (
        "{0} ohne Fläche: die Punkte liegen auf einer Linie; eine geschlossene Form zeichnen"
    ),
    "the {} meets itself: segments {} and {} cross or touch at ({}, {}); draw an outline that does not cross itself": (
        "{0} trifft sich selbst: Abschnitt {1} und {2} kreuzen oder berühren sich bei ({3}, {4}); einen Umriss zeichnen, "
        "der sich nicht selbst kreuzt"
    ),
    "the {} encloses {} parts that meet only where it crosses itself; draw each of them as an outline of its own": (
        "{0} umschließt {1} Teile, die sich nur an Kreuzungen treffen; jeden davon als eigenen Umriss zeichnen"
    ),
    "hole {} {}; each hole must lie inside the outline and apart from the others": (
        "Loch {0} {1}; jedes Loch muss im Umriss und getrennt von den anderen liegen"
    ),
    "the {} is not its own mirror image: near ({}, {}) it is {} off; allowed: {} (2 % of the drawing's size, 1.5 edge "
    "lengths); give another axis, or mesh it without mirror": (
        "{0} ist nicht das eigene Spiegelbild: bei ({1}, {2}) um {3} daneben; erlaubt: {4} (2 % der Größe der Zeichnung, "
        "1,5 Kantenlängen); eine andere Achse angeben, oder ohne „Spiegeln“ vernetzen"
    ),
    "the {} is not its own mirror image: near ({}, {}) it has no partner across the axis; allowed: {} (2 % of the "
    "drawing's size, 1.5 edge lengths); give another axis, or mesh it without mirror": (
        "{0} ist nicht das eigene Spiegelbild: bei ({1}, {2}) ohne Gegenstück jenseits der Achse; erlaubt: {3} (2 % der "
        "Größe der Zeichnung, 1,5 Kantenlängen); eine andere Achse angeben, oder ohne „Spiegeln“ vernetzen"
    ),
    "{} is {}; allowed: {}": "{0} ist {1}; erlaubt: {2}",
    "about {} triangles were asked for; at most {} are supported, use fewer (or a larger edge length)": (
        "rund {0} Dreiecke wurden verlangt; höchstens {1} werden unterstützt, weniger nehmen (oder eine größere Kantenlänge)"
    ),
    "no valid mesh was found: {} near ({}, {}); simplify the drawing there": (
        "kein gültiges Mesh gefunden: {0} bei ({1}, {2}); die Zeichnung dort vereinfachen"
    ),
    "the linear solve of the {} failed: {}": "das Gleichungssystem ({0}) war nicht lösbar: {1}",
    "cancelled": "abgebrochen",
    "the {} names vertex {}, but no vertices were given; give those of the mesh": (
        "{0} nennt Punkt {1}, aber es wurden keine Punkte gegeben; die des Meshs geben"
    ),
    "face {} was chosen, but no triangles were given; give those of the mesh": (
        "Fläche {0} wurde gewählt, aber es wurden keine Dreiecke gegeben; die des Meshs geben"
    ),
    "face {} was chosen; allowed: 0 to {}, one of the {} triangles given": (
        "Fläche {0} wurde gewählt; erlaubt: 0 bis {1}, eines der {2} gegebenen Dreiecke"
    ),
    "loop {} has {} vertices; at least 3 are needed, name all vertices around the hole in order": (
        "Schleife {0} hat {1} Punkte; mindestens 3 sind nötig, alle Punkte um das Loch der Reihe nach nennen"
    ),
    "the loop has {} vertices; at least 3 are needed, name all vertices around the hole in order": (
        "die Schleife hat {0} Punkte; mindestens 3 sind nötig, alle Punkte um das Loch der Reihe nach nennen"
    ),
    "loops {} and {} both pass through vertex {}; split it, or choose loops that are apart": (
        "Schleifen {0} und {1} gehen beide durch Punkt {2}; ihn teilen, oder getrennte Schleifen wählen"
    ),
    "loops {} and {} touch at vertices {} and {}, near ({}, {}, {}): no face fits between them there; merge the vertices "
    "by distance, or move one of the loops away": (
        "Schleifen {0} und {1} berühren sich an den Punkten {2} und {3}, bei ({4}, {5}, {6}): dort passt keine Fläche zwischen "
        "sie; die Punkte nach Abstand zusammenfügen, oder eine der Schleifen wegrücken"
    ),
    "loops {} and {}, around vertices {} and {}, look away from each other, as both ends of a pipe do: one patch between "
    "all the loops would meet itself; join them in pairs, or choose loops that face each other": (
        "Schleifen {0} und {1}, um die Punkte {2} und {3}, sehen voneinander weg, wie beide Enden eines Rohrs: ein Flicken "
        "zwischen allen Schleifen träfe sich selbst; sie paarweise verbinden, oder Schleifen wählen, die einander ansehen"
    ),
    "two loops are not two": "zwei Schleifen sind nicht zwei",
    "a new face has a vertex of the mesh that is of no loop": "eine neue Fläche hat einen Punkt des Netzes, der zu keiner Schleife gehört",
    "no faces were chosen; choose one connected region": (
        "keine Flächen wurden gewählt; ein zusammenhängendes Gebiet wählen"
    ),
    "the {} names vertex {}; allowed: 0 to {}, one of the {} vertices given": (
        "{0} nennt Punkt {1}; erlaubt: 0 bis {2}, einer der {3} gegebenen Punkte"
    ),
    "the loop names vertex {} twice in a row (places {} and {}); name each vertex once": (
        "die Schleife nennt Punkt {0} zweimal hintereinander (Stellen {1} und {2}); jeden Punkt einmal nennen"
    ),
    "the loop passes through vertex {} twice, like a figure eight; fill its parts one by one": (
        "die Schleife geht zweimal durch Punkt {0}, wie eine Acht; ihre Teile einzeln füllen"
    ),
    "{} of the edges meet in vertex {}; a loop has two at each vertex, deselect the others": (
        "{0} der Kanten treffen sich in Punkt {1}; eine Schleife hat zwei an jedem Punkt, die anderen abwählen"
    ),
    "the edges form an open chain from vertex {} to vertex {}; join its ends to a closed loop": (
        "die Kanten bilden eine offene Kette von Punkt {0} zu Punkt {1}; ihre Enden zu einer Schleife verbinden"
    ),
    "the loop's edge from vertex {} to vertex {} has no length; merge the two vertices": (
        "die Kante der Schleife von Punkt {0} zu Punkt {1} hat keine Länge; die zwei Punkte zusammenfügen"
    ),
    "the loop touches itself at vertices {} and {}, near ({}, {}, {}); merge or move apart what meets there": (
        "die Schleife berührt sich an den Punkten {0} und {1}, bei ({2}, {3}, {4}); zusammenfügen oder "
        "auseinanderrücken, was sich dort trifft"
    ),
    "the loop's edge from vertex {} to vertex {} has faces on both sides; there is no hole, choose edges of one face": (
        "die Kante der Schleife von Punkt {0} zu Punkt {1} hat Flächen auf beiden Seiten; dort ist kein Loch, Kanten "
        "mit einer Fläche wählen"
    ),
    "the border stops at vertex {} after the edge from vertex {} to vertex {}: an edge there joins more than two "
    "faces; delete the surplus ones": (
        "der Rand endet an Punkt {0} nach der Kante von Punkt {1} zu Punkt {2}: eine Kante dort verbindet mehr als zwei "
        "Flächen; die überzähligen löschen"
    ),
    "loop {} uses the edge from vertex {} to vertex {} like loop {}; give each loop edge to one loop": (
        "Schleife {0} benutzt die Kante von Punkt {1} zu Punkt {2} wie Schleife {3}; jede Kante nur einer Schleife geben"
    ),
    "the faces have no border; choose one connected region, not the whole of a closed mesh": (
        "die Flächen haben keinen Rand; ein zusammenhängendes Gebiet wählen, nicht ein geschlossenes Mesh als Ganzes"
    ),
    "the faces touch themselves or form a handle; choose a region like a sheet of paper": (
        "die Flächen berühren sich selbst oder bilden einen Henkel; ein Gebiet wie ein Blatt Papier wählen"
    ),
    "the faces have {} borders or touch themselves; choose one connected region without holes": (
        "die Flächen haben {0} Ränder oder berühren sich selbst; ein zusammenhängendes Gebiet ohne Löcher wählen"
    ),
    "the fill would meet itself or the mesh in {} pairs of triangles, first near ({}, {}, {}); split the loop there, "
    "or allow it": (
        "die Füllung träfe sich selbst oder das Mesh in {0} Paaren von Dreiecken, zuerst bei ({1}, {2}, {3}); die "
        "Schleife dort teilen, oder es erlauben"
    ),
    "face {} is not allowed: {}; each face needs three or more different vertices in order": (
        "Fläche {0} ist nicht erlaubt: {1}; jede Fläche braucht drei oder mehr verschiedene Punkte der Reihe nach"
    ),
    "the stroke has {} distinct points as it is seen along the cut; an open one needs 2, a closed one 3: draw across "
    "the model, or cut along another direction": (
        "der Strich hat in Richtung des Schnitts gesehen {0} verschiedene Punkte; ein offener braucht 2, ein "
        "geschlossener 3: quer über das Modell zeichnen, oder in einer anderen Richtung schneiden"
    ),
    "the cut would get about {} {}; at most {} are supported, use a larger edge length": (
        "der Schnitt bekäme rund {0} {1}; höchstens {2} werden unterstützt, eine größere Kantenlänge nehmen"
    ),
    "the mesh ends along the stroke already: a slice thinner than {} would come off; draw the stroke farther from its "
    "border, or ask for shorter edges": (
        "das Mesh endet schon am Strich: eine Scheibe dünner als {0} fiele ab; den Strich weiter weg vom Rand zeichnen, "
        "oder kürzere Kanten verlangen"
    ),
    "the stroke does not divide the mesh: all of it lies on one side, continued ends included; draw across the model": (
        "der Strich teilt das Mesh nicht: alles liegt auf einer Seite, auch mit fortgesetzten Enden; quer über das "
        "Modell zeichnen"
    ),
    "point {} of the {} is not in front of the eye; move the eye back, or cut along a direction": (
        "Punkt {0} ({1}) liegt nicht vor dem Auge; das Auge zurückbewegen, oder entlang einer Richtung schneiden"
    ),
    "the mesh cannot be cut here: {}, near ({}, {}, {}); move the stroke a little, or merge vertices that nearly "
    "coincide there": (
        "das Mesh lässt sich hier nicht schneiden: {0}, bei ({1}, {2}, {3}); den Strich etwas verschieben, oder Punkte "
        "zusammenfügen, die dort fast aufeinanderliegen"
    ),
    "a bug in gridmesh, please report it with this input: {}": (
        "ein Fehler in gridmesh, bitte mit dieser Eingabe melden: {0}"
    ),
    "none that work were found up to {}, use more or draw its thin parts wider": (
        "bis {0} wurden keine gefunden, die reichen; mehr nehmen oder die dünnen Teile breiter zeichnen"
    ),
    "use more (or a smaller edge length)": "mehr nehmen (oder eine kleinere Kantenlänge)",
    "{} work (or a smaller edge length)": "{0} reichen (oder eine kleinere Kantenlänge)",
    "the {} is {} across; allowed: 1e-30 to 1e30 (meshes and loops in space: 1e-60 to 1e60), scale it": (
        "{0}: {1} groß; erlaubt: 1e-30 bis 1e30 (Meshes und Schleifen im Raum: 1e-60 bis 1e60), skalieren"
    ),
    "what the stroke crosses still hangs together around the cut, near ({}, {}, {}); draw it across all that "
    "must come apart, or let its ends be extended": (
        "was der Strich kreuzt, hängt um den Schnitt herum noch zusammen, bei ({0}, {1}, {2}); über alles "
        "zeichnen, was getrennt werden soll, oder die Enden verlängern lassen"
    ),
    "part {} is not closed and manifold: {} near vertex {} at ({}, {}, {}); fill its holes and merge doubled vertices, "
    "or delete the surplus faces": (
        "Teil {0} ist nicht geschlossen und mannigfaltig: {1} bei Punkt {2} an ({3}, {4}, {5}); Löcher füllen und doppelte "
        "Punkte zusammenfügen, oder die überzähligen Flächen löschen"
    ),
    "the parts cannot be joined here: {}, near ({}, {}, {}); move one of them a little, blend less, or give them "
    "shorter edges there": (
        "die Teile lassen sich hier nicht verbinden: {0}, bei ({1}, {2}, {3}); eines davon etwas verschieben, schmaler "
        "überblenden oder ihnen dort kürzere Kanten geben"
    ),
    "the joints meet themselves or the parts in {} pairs of triangles, first near ({}, {}, {}); blend less, move a "
    "part, or allow it": (
        "die Verbindungen treffen sich selbst oder die Teile in {0} Paaren von Dreiecken, zuerst bei ({1}, {2}, {3}); "
        "schmaler überblenden, ein Teil verschieben oder es erlauben"
    ),
    "without relaxation triangles are inverted, one of them near ({}, {}); leave relax on, or use more triangles": (
        "ohne Relaxation sind Dreiecke umgestülpt, eines davon bei ({0}, {1}); relax anlassen oder mehr Dreiecke "
        "nehmen"
    ),
    "{} triangles are too few to follow this drawing": "{0} Dreiecke sind zu wenige für diese Zeichnung",
    "{} quads are too few to follow this drawing": "{0} Vierecke sind zu wenige für diese Zeichnung",
    "this drawing can be followed, but not covered": "der Zeichnung lässt sich folgen, sie aber nicht bedecken",
    "use a margin of 0": "den Rand auf 0 setzen",
}

# What errors of the library name: things, reasons, what is allowed.
_LIBRARY_PARTS = {
    "flattened loop": "flach gelegte Schleife",
    "face {}": "Fläche {0}",
    "hole {}": "Loch {0}",
    "loop": "Schleife",
    "mesh": "Mesh",
    "set of bones": "Satz von Knochen",
    "other outline": "Der andere Umriss",
    "outline": "Umriss",
    "stroke": "Strich",
    "stroke, continued straight on,": "gerade fortgesetzter Strich",
    "triangle {}": "Dreieck {0}",
    "values": "Werte",
    "fill": "Füllung",
    "inflation": "Aufblasen",
    "triangulation of the drawing": "Triangulierung der Zeichnung",
    "triangulation of the hole": "Triangulierung des Lochs",
    "automatic, and given": "automatisch, und gegeben",
    "grown, with quads": "grown, mit Vierecken",
    "optimal, or triangles: growth is that of a triangular lattice": (
        "optimal, oder Dreiecke: das Wachstum ist das eines Dreiecksgitters"
    ),
    "the drawing is too thin for three rows of quads": "die Zeichnung ist zu dünn für drei Reihen von Vierecken",
    "one of automatic, a number and an edge length": "eins von automatisch, einer Zahl und einer Kantenlänge",
    "lies inside hole {}": "liegt in Loch {0}",
    "lies outside the outline": "liegt außerhalb des Umrisses",
    "meets hole {}": "trifft Loch {0}",
    "edges along its lines": "Kanten an seinen Linien",
    "triangles in its caps": "Dreiecke in seinen Deckeln",
    "meets the outline": "trifft den Umriss",
    "a face has no area": "eine Fläche hat keinen Inhalt",
    "a face is on both sides": "eine Fläche liegt auf beiden Seiten",
    "a face is turned over": "eine Fläche ist umgestülpt",
    "a part of a face has no area": "ein Teil einer Fläche hat keinen Inhalt",
    "a part of the drawing is lost": "ein Teil der Zeichnung geht verloren",
    "a point of the cut is missing": "ein Punkt des Schnitts fehlt",
    "a triangle stays inverted": "ein Dreieck bleibt umgestülpt",
    "an edge has its ends on the wrong sides": "eine Kante hat ihre Enden auf den falschen Seiten",
    "an edge of a face is missing": "eine Kante einer Fläche fehlt",
    "an inlet is narrower than the grid": "eine Bucht ist schmaler als das Gitter",
    "every cap of quads repeats an edge of the mesh": "jeder Deckel aus Vierecken wiederholt eine Kante des Meshs",
    "cut lines touch each other": "Schnittlinien berühren sich",
    "edge {} of the loop passes through another vertex": (
        "Kante {0} der Schleife geht durch einen anderen Punkt"
    ),
    "every patch of quads repeats an edge of the mesh": "jeder Flicken aus Vierecken wiederholt eine Kante des Meshs",
    "every patch repeats an edge of the mesh": "jeder Flicken wiederholt eine Kante des Mesh",
    "it has fewer than 3 corners": "sie hat weniger als 3 Ecken",
    "it names a vertex twice": "sie nennt einen Punkt zweimal",
    "no lattice hexagon fits inside the drawing": "kein Sechseck des Gitters passt in die Zeichnung",
    "no lattice was tried": "kein Gitter wurde versucht",
    "no patch without an edge that the mesh has already": (
        "kein Flicken ohne eine Kante, die das Mesh schon hat"
    ),
    "offsets must begin with 0 and end with the number of corners": (
        "die Anfänge müssen mit 0 beginnen und mit der Zahl der Ecken enden"
    ),
    "out of memory": "zu wenig Speicher",
    "stretches of the cut meet where they should not": (
        "Stücke des Schnitts treffen sich, wo sie es nicht sollten"
    ),
    "the boundary is not symmetric": "der Rand ist nicht symmetrisch",
    "the cut does not divide a face": "der Schnitt teilt eine Fläche nicht",
    "the drawing is too thin for two rows of triangles": (
        "die Zeichnung ist zu dünn für zwei Reihen von Dreiecken"
    ),
    "the line enters a face and does not leave it": "die Linie tritt in eine Fläche ein und nicht wieder aus",
    "the line never enters a face": "die Linie tritt in keine Fläche ein",
    "the loop is not counter-clockwise": "die Schleife läuft nicht gegen den Uhrzeigersinn",
    "the loop meets itself at edge {}": "die Schleife trifft sich an Kante {0}",
    "the matrix is not positive definite ({})": "die Matrix ist nicht positiv definit ({0})",
    "the number of triangles is not reached": "die Zahl der Dreiecke wird nicht erreicht",
    "the patch has no interior vertex": "der Flicken hat keinen inneren Punkt",
    "part {}": "Teil {0}",
    "{} of part {}": "{0} von Teil {1}",
    "no part": "kein Teil",
    "as many numbers as parts": "so viele Zahlen wie Teile",
    "a number above 0, or nothing": "eine Zahl über 0, oder nichts",
    "a number from 0 to 1000, of edge lengths": "eine Zahl von 0 bis 1000, in Kantenlängen",
    "one closed mesh or more": "ein geschlossenes Mesh oder mehrere",
    "in part {} {}": "in Teil {0}: {1}",
    "an edge has a face on one side only": "eine Kante hat nur auf einer Seite eine Fläche",
    "two faces at an edge are wound against each other": "zwei Flächen an einer Kante laufen gegeneinander",
    "an edge joins more than two faces": "eine Kante verbindet mehr als zwei Flächen",
    "a piece of it is inside out, and its normals are to be flipped,": (
        "ein Stück ist umgestülpt, seine Normalen sind umzukehren,"
    ),
    "a cavity of it crosses what it lies in, or another cavity,": (
        "ein Hohlraum darin schneidet, was ihn umgibt, oder einen anderen Hohlraum,"
    ),
    "its faces lie on each other and enclose nothing": "seine Flächen liegen aufeinander und umschließen nichts",
    "the faces of a piece of it lie on each other and enclose nothing": (
        "die Flächen eines Stücks liegen aufeinander und umschließen nichts"
    ),
    "the Boolean operation on pieces of one part that touch broke down": (
        "die boolesche Operation auf Stücken eines Teils, die sich berühren, ist gescheitert"
    ),
    "what was taken away there has no border of whole edges": "was dort weggenommen wurde, hat keinen Rand aus ganzen Kanten",
    "the Boolean operation on them broke down": "die boolesche Operation auf ihnen ist gescheitert",
    "the Boolean operation on them has no result": "die boolesche Operation auf ihnen hat kein Ergebnis",
    "the Boolean operation on them has no sound result": "die boolesche Operation auf ihnen hat kein brauchbares Ergebnis",
    "the patches do not fit together": "die Flicken passen nicht zusammen",
    "a rim borders nothing that was taken away": "ein Rand grenzt an nichts, was weggenommen wurde",
    "the rim of a tunnel is too rough to be capped": "der Rand eines Tunnels ist für einen Deckel zu rau",
    "the solution is not finite": "die Lösung ist nicht endlich",
    "the triangle of the vertices {} of the patch is not positive": (
        "das Dreieck der Punkte {0} des Flickens ist nicht positiv"
    ),
    "a contour is too thin to have an inside": "eine Kontur ist zu dünn, um ein Inneres zu haben",
    "a part is too narrow for two rows of triangles": "ein Teil ist zu schmal für zwei Reihen von Dreiecken",
    "no lattice path goes round a contour this small": "kein Weg im Gitter führt um eine so kleine Kontur",
    "two walls are too close together to pass each other": "zwei Wände sind zu nah beisammen für zwei Wege",
    "two parts of the boundary stay one edge apart": (
        "zwei Teile des Rands bleiben nur eine Kante auseinander"
    ),
    "two points of the cut coincide": "zwei Punkte des Schnitts fallen zusammen",
    "two walls of the drawing are too near to each other": "zwei Wände der Zeichnung sind einander zu nah",
    "unknown {} is in no equation": "Unbekannte {0} steht in keiner Gleichung",
    "vertices {} and {} of the loop coincide": "die Punkte {0} und {1} der Schleife fallen zusammen",
    "0 at first, for the body is closed there": "0 am Anfang, denn dort ist der Körper geschlossen",
    "0 to 100": "0 bis 100",
    "0 to pi radians": "0 bis pi im Bogenmaß",
    "0, or no mirror: symmetric boundaries are proved only where none conflicts": (
        "0, oder ohne Spiegeln: symmetrische Ränder sind nur bewiesen, wo keiner im Widerspruch steht"
    ),
    "0.5 to 4 edge lengths": "0.5 bis 4 Kantenlängen",
    "a depth above 0 where the front's is 0, or the body is flat": (
        "eine Tiefe über 0, wo die der Vorderseite 0 ist, sonst ist der Körper flach"
    ),
    "a finite angle in radians, or none": "ein endlicher Winkel im Bogenmaß, oder keiner",
    "a finite length above 0": "eine endliche Länge über 0",
    "a finite number above 0, or None": "eine endliche Zahl über 0, oder None",
    "a finite number, 0 or more": "eine endliche Zahl ab 0",
    'a finite point and a finite direction that is not zero, or "auto"': (
        'ein endlicher Punkt und eine endliche Richtung, die nicht null ist, oder "auto"'
    ),
    "a point with finite coordinates, or none": "ein Punkt mit endlichen Koordinaten, oder keiner",
    "a point within a million edge lengths of the outline, or none": (
        "ein Punkt innerhalb von einer Million Kantenlängen um den Umriss, oder keiner"
    ),
    "an angle in radians, 0 or more": "ein Winkel im Bogenmaß ab 0",
    "as many vertices as the filled mesh has": "so viele Punkte, wie das gefüllte Mesh hat",
    "at least 6": "mindestens 6",
    "given beside edge_length": "neben edge_length gegeben",
    "given beside what it decides": "neben dem gegeben, was es bestimmt",
    "no edge_length, number of cells, angle, origin or mirror beside it, or none": (
        "weder edge_length noch eine Zahl von Zellen, angle, origin oder mirror daneben, oder keines"
    ),
    "given, with boundary grown": "gegeben, mit gewachsenem Rand",
    "grown, with holes": "gewachsen, mit Löchern",
    "none, or boundary optimal: growth has no symmetric form": (
        "keins, oder optimaler Rand: Wachstum hat keine symmetrische Form"
    ),
    "none, or the angle of the axis, modulo 90 degrees": ("keiner oder der Winkel der Achse, modulo 90 Grad"),
    "none, or the angle of the axis or 30 degrees from it, modulo 60 degrees": (
        "keiner, oder der Winkel der Achse oder 30 Grad daneben, modulo 60 Grad"
    ),
    "none, with mirror: the lattice lies on the axis": "keiner, mit Spiegeln: das Gitter liegt auf der Achse",
    "numbers from 0.000001 to 1000000 after the first": "Zahlen von 0.000001 bis 1000000 nach der ersten",
    "of different fills": "von verschiedenen Füllungen",
    "of length {}": "von der Länge {0}",
    "one counter-clockwise fan of triangles around each vertex": (
        "ein Fächer von Dreiecken gegen den Uhrzeigersinn um jeden Punkt"
    ),
    "one number for each triangle, or none": "eine Zahl je Dreieck, oder keine",
    "one number, or one per point of the outline": "eine Zahl, oder eine je Punkt des Umrisses",
    "one of edge_length and triangles, or neither": "eins von edge_length und triangles, oder keins",
    "one rim for each contour, numbered in a row, with increasing arc positions": (
        "ein Rand je Kontur, der Reihe nach nummeriert, mit wachsenden Bogenlängen"
    ),
    "one row for each vertex of the loop": "eine Zeile je Punkt der Schleife",
    "optimal, if there are holes": "optimal, wenn Löcher da sind",
    "the parts of one fill": "die Teile einer Füllung",
    "three finite numbers": "drei endliche Zahlen",
    "three finite numbers, not all zero": "drei endliche Zahlen, nicht alle null",
    "two values or more, the first of them 0": "zwei Werte oder mehr, der erste davon 0",
    "not a patch at vertex {}": "kein Flicken an Punkt {0}",
    "{} at first": "{0} am Anfang",
    "{} rims with {} vertices": "{0} Ränder mit {1} Punkten",
    "{} values": "{0} Werte",
    "{}, beside mirror": "{0}, neben Spiegeln",
    "0, or a largest number from 1e-9 on": "0, oder eine größte Zahl ab 1e-9",
    "0, or numbers up to 1e9": "0, oder Zahlen bis 1e9",
    "a height is not a number": "eine Höhe ist keine Zahl",
    "a loop has neither a fill nor an error": "eine Schleife hat weder Füllung noch Fehler",
    "a number from 1e-9 to 1e9": "eine Zahl von 1e-9 bis 1e9",
    "a thread of a fill died": "ein Thread einer Füllung brach ab",
    "a vertex is not finite": "ein Punkt ist nicht endlich",
    "a vertex was not collected": "ein Punkt wurde nicht gesammelt",
    "a number above 0 and below 1, or automatic": "eine Zahl über 0 und unter 1, oder automatisch",
    "a number from 0 to 10": "eine Zahl von 0 bis 10",
    "a number of square pixels, 0 or more": "eine Anzahl von Quadratpixeln, 0 oder mehr",
    "a number of pixels from 0 to 1000": "eine Anzahl von Pixeln von 0 bis 1000",
    "no caps were made": "keine Deckel wurden gemacht",
    "point {}, normal {}, distance {}": "Punkt {0}, Normale {1}, Abstand {2}",
    "the picture is {} by {} pixels; allowed: 1 to {} pixels in all, scale it": (
        "das Bild hat {0} mal {1} Pixel; erlaubt: insgesamt 1 bis {2} Pixel, das Bild verkleinern"
    ),
    "the pixel in row {}, column {} of the picture is NaN or infinite; all values must be finite": (
        "das Pixel in Zeile {0}, Spalte {1} des Bildes ist NaN oder unendlich; alle Werte müssen endlich sein"
    ),
    # Files of pictures
    "it breaks the decoder": "der Dekoder scheitert daran",
    "it has more than one frame; save the one that is meant as a picture": (
        "es hat mehr als ein Einzelbild; das gemeinte als Bild speichern"
    ),
    "it is cut off": "es ist abgeschnitten",
    "it is damaged ({})": "es ist beschädigt ({0})",
    "it is empty": "es ist leer",
    "it is no PNG, JPEG or WebP": "es ist weder PNG noch JPEG noch WebP",
    # Weights
    "bone weights": "Knochengewichte",
    "Select flat meshes, and then an armature": "Flache Meshes auswählen und dann eine Armature",
    "Cancelled; nothing was changed": "Abgebrochen; nichts wurde geändert",
    "the armature has no bones that deform": "die Armature hat keine Knochen, die verformen",
    "it is not flat; select the body and then the armature, and choose Object > Parent > With Automatic Weights": (
        "es ist nicht flach; den Körper und dann die Armature auswählen und Objekt > Parent > Mit automatischer Wichtung wählen"
    ),
    "it has no faces": "es hat keine Flächen",
    "{}: weights for {}": "{0}: Gewichte für {1}",
    "{} bone": "{0} Knochen",
    "{} bones": "{0} Knochen",
    "one bone or more": "ein Knochen oder mehr",
    "1 or more bones for a vertex": "1 oder mehr Knochen je Punkt",
    "a number from 0.01 to 100": "eine Zahl von 0.01 bis 100",
    "the picture cannot be read: {}; allowed: PNG, JPEG and WebP, each of one picture": (
        "das Bild kann nicht gelesen werden: {0}; erlaubt: PNG, JPEG und WebP mit je einem Bild"
    ),
    # Pictures
    "it has {} by {} pixels; allowed: 1 to {} pixels in all, scale it": (
        "es hat {0} mal {1} Pixel; erlaubt: insgesamt 1 bis {2} Pixel, das Bild verkleinern"
    ),
    "all of its {} islands are smaller than the least area; lower it": (
        "alle {0} Inseln sind kleiner als die kleinste Fläche; diese verringern"
    ),
    "nothing in it is covered; choose another background or a lower threshold": (
        "nichts darin ist bedeckt; einen anderen Hintergrund oder eine niedrigere Schwelle wählen"
    ),
    "{} is {}; allowed: 1 or more": "{0} ist {1}; erlaubt: 1 oder mehr",
    "it shows no picture; select an image empty or an image plane": (
        "es zeigt kein Bild; ein Bild-Empty oder eine Bildebene auswählen"
    ),
    "it has more than one frame or tile; save the one that is meant as a picture": (
        "es hat mehr als ein Einzelbild oder eine Kachel; das gemeinte als Bild speichern"
    ),
    "its file is missing or damaged; find it, or save it again": (
        "seine Datei fehlt oder ist beschädigt; sie suchen oder neu speichern"
    ),
    "its UV map does not lay the picture flat over it; use a plane or an image empty": (
        "seine UV-Map legt das Bild nicht flach darüber; eine Ebene oder ein Bild-Empty nehmen"
    ),
    "no picture is selected; select an image empty or an image plane, or give a file": (
        "kein Bild ist ausgewählt; ein Bild-Empty oder eine Bildebene auswählen, oder eine Datei angeben"
    ),
    "'{}' cannot be read; save it as PNG, JPEG or WebP": (
        "„{0}“ lässt sich nicht lesen; als PNG, JPEG oder WebP speichern"
    ),
    "its material has no picture any more; make it anew from the picture": (
        "sein Material hat kein Bild mehr; es neu aus dem Bild machen"
    ),
    "it is linked from another file; make it local": "es ist aus einer anderen Datei verknüpft; lokal machen",
    "it has shape keys, which fit no new mesh; remove them": (
        "es hat Formschlüssel, die zu keinem neuen Mesh passen; sie entfernen"
    ),
    "it was changed by hand and is left as it is; make it anew from the picture": (
        "es wurde von Hand geändert und bleibt, wie es ist; es neu aus dem Bild machen"
    ),
    "Leave the mode to make meshes of pictures": "Den Modus verlassen, um aus Bildern Meshes zu machen",
    "Select a sprite or a body made from a picture": "Ein Sprite oder einen Körper auswählen, der aus einem Bild gemacht ist",
    "{} updated": "{0} aktualisiert",
    "{}: a part is left out: {}": "{0}: ein Teil ist weggelassen: {1}",
    "{}: lines are too thin for a mesh; all is {} px wider to each side": (
        "{0}: Linien sind zu dünn für ein Mesh; alles ist auf jeder Seite {1} px breiter"
    ),
    "{}: more faces than the {} asked for; {}": "{0}: mehr Flächen als die {1} verlangten; {2}",
    "fewer cannot follow its thin lines": "weniger können seinen dünnen Linien nicht folgen",
    "its thin parts and corners take more": "seine dünnen Teile und Ecken brauchen mehr",
    "fewer cut off more of its tips": "weniger schneiden mehr von seinen Spitzen ab",
    "fewer follow its outline less closely": "weniger folgen seinem Umriss weniger genau",
    "fewer have short edges": "weniger haben kurze Kanten",
    "fewer have short edges in its thin parts beside long ones": (
        "weniger haben kurze Kanten in seinen dünnen Teilen neben langen"
    ),
    "{}: {} left out, smaller than Least Area": "{0}: {1} weggelassen, kleiner als „Kleinste Fläche“",
    "{} picture": "{0} Bild",
    "{} pictures": "{0} Bilder",
    "{} part": "{0} Teil",
    "{} parts": "{0} Teile",
    "{} mesh": "{0} Mesh",
    "{} meshes": "{0} Meshes",
    "{} island": "{0} Insel",
    "{} islands": "{0} Inseln",
    "an angle from 0 to pi, in radians, or nothing": "ein Winkel von 0 bis pi, in Radiant, oder nichts",
    "an edge has no slot": "eine Kante hat keinen Platz",
    "finite points, normals that are not zero, of length 1, and distances of 0 or more": (
        "endliche Punkte, Normalen der Länge 1, die nicht null sind, und Abstände ab 0"
    ),
    "no film to fall back on": "kein früherer Stand, auf den man zurückfallen kann",
    "the sides of the drawing differ and do not": (
        "die Seiten der Zeichnung sind verschieden und sind es nicht"
    ),
    "'width' or none: the outer outline has other points": "'width' oder nichts: der äußere Umriss hat andere Punkte",
    "0 to 1": "0 bis 1",
    "a number from 0 to 1, or one for each point": "eine Zahl von 0 bis 1, oder eine für jeden Punkt",
    "finite numbers above 0": "endliche Zahlen über 0",
    "given, with bend 0": "gegeben, mit bend 0",
    "none, or bend above 0: triangles of a straight lattice have one size": "nichts, oder bend über 0: Dreiecke eines geraden Gitters haben eine Größe",
    "numbers, beside self_crossing union": "Zahlen, neben self_crossing union",
    "one number for each point of the outline, and of each hole that has any": "eine Zahl je Punkt des Umrisses, und jedes Lochs, das welche hat",
    "{} numbers": "{0} Zahlen",
}

MESSAGES = (
    _COUNTED
    | _COMMON
    | _STROKES
    | _ENTRIES
    | _LIVE
    | _DRAW
    | _CUTS
    | _FILLS
    | _BRIDGES
    | _JOINS
    | _QUALITY
    | _MODULE
    | _LIBRARY
    | _LIBRARY_PARTS
)
